#pragma once
/// \file
/// What a fit needs of anything that can be simulated: named inputs in, channels of rows out. The
/// point driver stands behind it in point_simulator.hpp; a full simulation may too.

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace repose::calibration {

/// A simulated curve: the abscissa x and one column per channel, row by row in the order in which
/// they were passed. A path that broke off has fewer rows, and `finished` < 1.
struct Response {
  Eigen::VectorXd x;                ///< rows
  Eigen::MatrixXd y;                ///< rows × channels
  Eigen::MatrixXd dx;               ///< rows × wanted inputs (with derivatives only)
  std::vector<Eigen::MatrixXd> dy;  ///< per channel: rows × wanted inputs
  /// The last state before a path broke off (channels); empty if not even a start was possible.
  Eigen::RowVectorXd last;
  double finished = 1.0;    ///< share of the path that was passed, smooth in the inputs
  std::string_view reason;  ///< static text: why it broke off; empty if it did not
  bool complete() const { return reason.empty(); }
};

class Simulator {
 public:
  virtual ~Simulator() = default;
  /// Names of the inputs, in the order in which simulate() takes them.
  virtual const std::vector<std::string>& inputs() const = 0;
  /// Can it give derivatives itself? If not, they are taken by differences.
  virtual bool has_derivatives() const = 0;
  /// Half the span over which differences are taken, in units of a parameter's bounds: small for a
  /// smooth answer, larger than the grain of one that is not (a full simulation's front).
  virtual double difference_step() const { return 1e-5; }
  /// For a picture: the same experiment with rows close to each other along its way, of the
  /// channels named; nothing where there are no such rows or channels.
  virtual std::shared_ptr<const Simulator> drawn(std::span<const std::string>) const { return {}; }
  /// The same experiment with its abscissae multiplied, to tell whether a misfit is one of units;
  /// nothing where they are not its own or lead nowhere.
  virtual std::shared_ptr<const Simulator> with_abscissae_times(double) const { return {}; }
  /// Simulates. wanted: positions of the inputs to differentiate by; empty for none. Never throws
  /// for numbers; must be callable from several threads at once.
  virtual void simulate(std::span<const double> inputs, std::span<const int> wanted,
                        Response& response) const = 0;
};

}  // namespace repose::calibration
