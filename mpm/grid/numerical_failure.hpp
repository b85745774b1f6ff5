#pragma once

#include <stdexcept>

namespace repose::mpm {

/// Thrown where a run cannot go on: the step, time, point, reason and cause (input or solver) are
/// in what(). The simulation is left as that step has made it, complete enough to be written out; a
/// point whose stress could not be updated has moved and keeps the stress from before.
class NumericalFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace repose::mpm
