#pragma once
/// \file
/// Why a fit is far from its data: units, signs or the start, told by trying.

#include <string>
#include <vector>

#include "calibration/multistart.hpp"

namespace repose::calibration {

/// What was tried with one target and made the misfit small.
struct MisfitCause {
  std::size_t target = 0;
  std::vector<std::size_t> channels;  ///< those multiplied; empty: the abscissae
  double factor = 1.0;
  double before = 0.0, after = 0.0;  ///< largest rms over the range of a channel of the target
};

/// For every fitted target whose misfit is large (ChannelScore::large): its channels, one by one
/// and those of one unit together, and its abscissae are multiplied by −1, 100, 1000 and their
/// inverses, the target is fitted alone from the best values and from the start, and the factor
/// that leaves least is a cause if it brings the misfit below a third of what it is without and
/// below a tenth of the range. At most one cause per target.
std::vector<MisfitCause> misfit_causes(const Problem& problem, const Eigen::VectorXd& z);

/// "q_Pa and u_Pa look 1000 times too small (0.6 % of the range is left instead of 1600 %): …"
std::string in_words(const Problem& problem, const MisfitCause& cause);

}  // namespace repose::calibration
