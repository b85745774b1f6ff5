#pragma once
/// \file
/// How far runs with finite cells are from what they tend to: a model with few constants, and what
/// the runs of a scene themselves say. It predicts the error bar of an estimate before it is made.

#include <vector>

#include "calibration/richardson.hpp"

namespace repose::calibration {

/// Of one quantity in one kind of scene. x = h/ℓ, ℓ a length of the scene; all are relative.
struct ErrorModel {
  double bias = 0.0;       ///< |u(h) − u*|₁/|u*|₁ is typically bias·x^order
  double order = 1.0;      ///< p
  double remainder = 0.0;  ///< error bar of an extrapolated value over the bias of its finest run
  double scatter = 0.0;    ///< of one run, from a step to one close by: scatter·x^scatter_order
  double scatter_order = 0.0;

  double expected_bias(double x) const;
  double expected_scatter(double x) const;
};

/// An estimate of what the runs tend to.
struct Estimate {
  Eigen::VectorXd value;
  double error = 0.0;   ///< error bar, relative: holds in four of five cases
  double weight = 0.0;  ///< value = u_f + weight (u_f − u_c)
};

/// Runs per cell size.
struct Level {
  double h = 0.0;
  int runs = 1;
};

/// The model together with the runs so far. Richardson's estimate û = u_f + w (u_f − u_c) from the
/// finest cells f and the finest c at least 1.9 times as large would carry (1 + w) times the
/// scatter of the fine runs and w times that of the coarse ones, so that w is shortened where
/// scatter rules: with B the bias of the fine runs and w_1 = 1/(r^p − 1), r = h_c/h_f,
///     E(w) = B² (1 − w/w_1)² + σ_f² (1 + w)²/n_f + σ_c² w²/n_c
/// is least at w = (B²/w_1 − σ_f²/n_f)/(B²/w_1² + σ_f²/n_f + σ_c²/n_c), at least 0. The error bar
/// is √((remainder B)² + 1.28² E). B is the root mean square of the model's bias and of those that
/// the last two sizes show, w_1 |u_f − u_c|₁ less its scatter, each carried to the size in question
/// as h^p; σ is that of the model, scaled by the scatter seen.
class Convergence {
 public:
  Convergence(const ErrorModel& model, double length) : model_(model), length_(length) {}

  /// Takes a run; a new size must be finer than all before.
  void add(double h, Eigen::VectorXd value);
  const std::vector<Resolution>& levels() const { return levels_; }

  /// Error bar of the estimate that these levels, coarse to fine, would give; infinite where none
  /// is 1.9 times as coarse as the finest.
  double predicted_error(const std::vector<Level>& levels) const;
  /// From the runs so far; its error is infinite if there is nothing to extrapolate from.
  Estimate estimate() const;
  /// B: the relative error that runs with cells of h are expected to have, scatter aside.
  double bias_at(double h) const;

 private:
  struct Weighted {
    double weight, error;
  };
  Weighted best_weight(const Level& coarse, const Level& fine) const;
  double scatter_at(double h) const;

  ErrorModel model_;
  double length_;
  std::vector<Resolution> levels_;
};

/// What one scene's levels show against what they tend to, for an ErrorModel of order 1: bias and
/// scatter as root mean squares over the sizes, and the errors of the estimates that could be made
/// on the way, over the expected bias (the finest of more than two sizes is left out: what it tends
/// to was extrapolated from it). Scatter is at least 1e-4.
struct ShownErrors {
  double bias = 0.0, scatter = 0.0;
  std::vector<double> remainders;
};
ShownErrors shown_errors(std::span<const Resolution> levels, const Eigen::VectorXd& tends_to,
                         double length);

/// The model of several scenes: root mean squares; the remainder times 1.28, so that it bounds four
/// of five cases.
ErrorModel pooled_model(std::span<const ShownErrors> scenes);

/// What to run.
struct Plan {
  std::vector<Level> levels;
  double error = 0.0;  ///< predicted error bar
  double cost = 0.0;   ///< of all its runs, those made already included [s]
};

/// The cheapest plan whose predicted error bar is at most `target`, and where there is none the
/// most accurate of those that cost at most `budget`, with its error above target; the cheapest of
/// all where none does. sizes: cells to choose from, coarse to fine; seconds: of one run with each.
/// A plan runs the sizes made so far, those from there on that are the coarsest over a power of 2,
/// and a finest; all with the same number of runs, at most `most_runs`.
Plan cheapest_plan(const Convergence& so_far, const std::vector<double>& sizes,
                   const std::vector<double>& seconds, double target, double budget,
                   int most_runs = 8);

}  // namespace repose::calibration
