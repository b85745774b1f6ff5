#pragma once
/// \file
/// One experiment of a fit: what was measured, what simulates it, and the residuals between both,
/// always at the experiment's own points.

#include <memory>
#include <optional>

#include "calibration/simulator.hpp"

namespace repose::calibration {

/// A measured quantity over the rows of its experiment.
struct Channel {
  std::string name;
  Eigen::VectorXd observed;
  std::optional<double> noise;  ///< standard deviation of the measurement, in the channel's unit
  double weight = 1.0;
  /// Row by row where it differs (then `noise` is their root mean square); empty: the same in all.
  Eigen::VectorXd row_noise{};
};

/// How a simulated curve meets the data.
enum class Compare : std::uint8_t {
  rows,         ///< the simulator's rows are the data's rows
  interpolate,  ///< the simulated curve is read at the data's x; where x turns round (unloading),
                ///< branch by branch in the order of the path
  distance      ///< signed normal distance from each data point to the simulated curve, for
                ///< softening and cyclic curves; axes scaled by the ranges of the data
};

/// A simulator's input that takes the value of a free parameter.
struct Binding {
  int input = 0;
  int parameter = 0;
};

struct Target {
  std::string name;
  std::shared_ptr<const Simulator> simulator;
  std::vector<double> inputs;  ///< of the simulator; those bound are replaced
  std::vector<Binding> bindings;
  std::string x_name;
  Eigen::VectorXd x;  ///< rows
  std::vector<Channel> channels;
  double weight = 1.0;
  bool held_out = false;  ///< predicted and scored, not fitted
  Compare compare = Compare::rows;
  /// Interpolation: a row beyond the end of its branch is compared with the branch's straight
  /// continuation, so that its residual tells how far it is away; else with the end itself.
  bool continues = false;

  Eigen::Index rows() const { return x.size(); }
  /// Rows of all channels.
  Eigen::Index count() const { return rows() * static_cast<Eigen::Index>(channels.size()); }
};

/// Where a series turns round (by more than a hundredth of its range), and its last value.
std::vector<double> turning_points(const Eigen::VectorXd& x);

/// What a channel's residual is divided by: its noise, or the range of what was measured.
double scale_of(const Channel& channel);
/// The same for one row.
double scale_of(const Channel& channel, Eigen::Index row);
/// A noise of √(absolute² + (relative |observed|)²), given the channel's observed values. Errors:
/// InputError (key "noise") if it vanishes in a row.
void declare_noise(Channel& channel, double absolute, double relative);

/// Unweighted residuals of one simulation, channel after channel, in units of scale_of(); `slope`
/// (rows × wanted inputs) if the response has derivatives. Rows that a broken-off path did not
/// reach keep its last state, so that residuals stay continuous as the path grows.
struct Misfit {
  Eigen::VectorXd r;
  Eigen::MatrixXd slope;
  Eigen::MatrixXd simulated;  ///< rows × channels: the value each data point is compared with
  bool finite = true;
  Eigen::Index beyond = 0;  ///< rows of the data beyond the end of a complete simulated curve
};
void misfit(const Target& target, const Response& response, Misfit& out);

}  // namespace repose::calibration
