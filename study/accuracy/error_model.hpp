#pragma once
/// \file
/// How far runs with finite cells are from what they tend to: a model with few constants, and what
/// the runs of a scene themselves say. It predicts the error of an estimate before it is made.

#include <optional>
#include <utility>
#include <vector>

#include "study/accuracy/richardson.hpp"

namespace repose::study {

/// Of one quantity in one kind of scene. x = h/ℓ, ℓ a length of the scene; all are relative.
/// m = |u − u_0|₁/|u|₁ is the quantity's motion, how far it has gone from its value at the start:
/// what has hardly moved is hardly wrong.
struct ErrorModel {
  double bias = 0.0;          ///< |u(h) − u*|₁/|u*|₁ is typically bias·m^γ·x^order
  double order = 1.0;         ///< p
  double motion_order = 0.0;  ///< γ
  double motion = 1.0;        ///< m of a typical scene, until a run tells
  double irregularity = 0.0;  ///< how far one size's bias is off c·x^p, over it
  double scatter = 0.0;       ///< of one run, from a step to one close by: scatter·x^scatter_order
  double scatter_order = 0.0;
  double caution = 1.0;  ///< the error bar over the expected error E of an estimate

  /// With a scene's own motion; less than 0.02 counts as 0.02.
  double expected_bias(double x, double scene_motion) const;
  double expected_scatter(double x) const;
};

/// An estimate of what the runs tend to.
struct Estimate {
  Eigen::VectorXd value;
  double error = 0.0;       ///< error bar, relative
  Eigen::VectorXd weights;  ///< of the sizes, coarse to fine; their sum is 1
};

/// Runs per cell size.
struct Level {
  double h = 0.0;
  int runs = 1;
};

/// The model together with the runs so far. With x_k = (h_k/h_f)^p, f the finest cells, the mean of
/// n_k runs is taken to be
///     u_k = u* + B x_k d + δ_k,   |δ_k|² ~ s_k² = (irregularity B x_k)² + σ_k²/n_k,
/// one direction d for all sizes and δ_k independent. The estimate û = Σ a_k u_k, Σ a_k = 1, with
/// the least expected square of the error,
///     E² = B² (Σ a_k x_k)² + Σ a_k² s_k²,
/// has a = E² M⁻¹ 1 and E² = 1/(1ᵀ M⁻¹ 1), M = B² x xᵀ + diag(s²): it is Richardson's extrapolation
/// where the sizes err regularly, the finest run alone where they do not, and a mean of many runs
/// where scatter rules. B² is the geometric mean of the model's, which counts as one pair, and of
/// the mean of what the pairs of the finest size f with a coarser one k (1.4 ≤ h_k/h_f ≤ 4.5) show,
///     (|u_k − u_f|² − σ_k²/n_k − σ_f²/n_f)/((x_k − 1)² + irregularity² (x_k² + 1));
/// σ is that of the model, scaled by the scatter seen. The error bar is caution·E.
class Convergence {
 public:
  Convergence(const ErrorModel& model, double length) : model_(model), length_(length) {}

  /// The quantity at the start, which motions are measured from; without it the typical one counts.
  void starts_from(Eigen::VectorXd value) { start_ = std::move(value); }
  /// Takes a run; a new size must be finer than all before.
  void add(double h, Eigen::VectorXd value);
  const std::vector<Resolution>& levels() const { return levels_; }

  /// Error bar of the estimate that these levels, coarse to fine, would give.
  double predicted_error(const std::vector<Level>& levels) const;
  /// From the runs so far, of which there must be one.
  Estimate estimate() const;
  /// B: the relative error that runs with cells of h are expected to have, scatter aside.
  double bias_at(double h) const;
  /// The bias that the pairs of sizes show, over the one that the model alone expects; 0 where
  /// there are none.
  double shown_over_expected() const;
  /// Standard deviation of one run with cells of h, relative: the model's, scaled by the scatter
  /// seen.
  double scatter_at(double h) const;

 private:
  struct Weighted {
    Eigen::VectorXd weights;
    double error;
  };
  Weighted best_weights(const std::vector<Level>& levels) const;
  /// m of the finest run so far.
  double motion() const;
  /// Mean square of the biases that the pairs show at the finest size, and their number.
  std::pair<double, double> shown_square() const;

  ErrorModel model_;
  double length_;
  std::vector<Resolution> levels_;
  std::optional<Eigen::VectorXd> start_;
};

/// What one scene's levels show against what they tend to, for a model of `form`'s orders: bias and
/// scatter (at least 1e-4) as root mean squares over the sizes, irregularity from sizes whose
/// error is at least twice the uncertainty of u* and the scatter (NaN where these are fewer than
/// three), and the motion of u* (1 without a start).
struct ShownErrors {
  double bias = 0.0, irregularity = 0.0, scatter = 0.0, motion = 1.0;
};
ShownErrors shown_errors(std::span<const Resolution> levels, const Eigen::VectorXd& tends_to,
                         double uncertainty, double length, const ErrorModel& form,
                         const std::optional<Eigen::VectorXd>& start = {});

/// The model of several scenes: geometric means of biases and motions, root mean squares of all
/// else; the rest as in `form`.
ErrorModel pooled_model(std::span<const ShownErrors> scenes, const ErrorModel& form);

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
/// and a finest; all with the same number of runs, at most `most_runs`. It has two sizes at least.
Plan cheapest_plan(const Convergence& so_far, const std::vector<double>& sizes,
                   const std::vector<double>& seconds, double target, double budget,
                   int most_runs = 8);

}  // namespace repose::study
