#include <algorithm>
#include <chrono>
#include <cmath>

#include "calibration/dense.hpp"
#include "calibration/optimise.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Coordinates that may move: not held, and not pressed against a bound by the gradient.
std::vector<Index> movable(const VectorXd& z, const VectorXd& g, const std::vector<bool>& fixed) {
  std::vector<Index> free;
  for (Index i = 0; i < z.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (k < fixed.size() && fixed[k]) continue;
    if ((z[i] <= 0.0 && g[i] > 0.0) || (z[i] >= 1.0 && g[i] < 0.0)) continue;
    free.push_back(i);
  }
  return free;
}

/// min ‖J_f d + r‖² + μ‖D d‖² by QR, z + d within the cube: what would leave it stops at its bound,
/// and the others are solved again with that. A coordinate of next to no influence would else take
/// a share of the others' step that its bounds do not let it go.
VectorXd damped_step(const MatrixXd& J, const VectorXd& r, const VectorXd& scale,
                     std::vector<Index> free, double mu, const VectorXd& z) {
  VectorXd step = VectorXd::Zero(J.cols()), rest = r;
  while (!free.empty()) {
    const auto n = static_cast<Index>(free.size());
    MatrixXd A = MatrixXd::Zero(J.rows() + n, n);
    VectorXd b = VectorXd::Zero(J.rows() + n);
    b.head(J.rows()) = -rest;
    for (Index j = 0; j < n; ++j) {
      const Index k = free[static_cast<std::size_t>(j)];
      A.col(j).head(J.rows()) = J.col(k);
      A(J.rows() + j, j) = std::sqrt(mu) * scale[k];
    }
    const VectorXd d = least_squares(A, b);
    std::vector<Index> inside;
    for (Index j = 0; j < n; ++j) {
      const Index k = free[static_cast<std::size_t>(j)];
      const double to = z[k] + d[j];
      step[k] = std::min(1.0, std::max(0.0, to)) - z[k];
      if (to >= 0.0 && to <= 1.0)
        inside.push_back(k);
      else
        rest += step[k] * J.col(k);
    }
    if (inside.size() == free.size()) break;
    free = std::move(inside);
  }
  return step;
}

/// The last digits. Near the optimum the objective is flat: round-off hides from it what the
/// gradient still shows, so these steps are judged by their own length, which must shrink.
/// Directions of next to no influence keep their place by a little damping; where the first step is
/// not small already, some direction is not determined, and nothing is done.
void finish(const Problem& problem, const OptimiseOptions& options, const VectorXd& scale,
            Evaluation& here, Optimum& best) {
  constexpr double damping = 1e-12, first_step = 1e-4, round_off = 1e-10;
  double before = first_step;
  Evaluation there;
  while (best.evaluations + best.gradients < options.max_evaluations && !problem.interrupted()) {
    const VectorXd g = here.J.transpose() * here.r;
    const VectorXd D = scale.cwiseMax(here.J.colwise().norm().transpose());
    const VectorXd z =
        clipped(best.z + damped_step(here.J, here.r, D.cwiseMax(1e-8 * D.maxCoeff()),
                                     movable(best.z, g, options.fixed), damping, best.z));
    const double moved = (z - best.z).cwiseAbs().maxCoeff();
    if (!(moved < 0.7 * before) || moved < 1e-15) return;
    problem.evaluate(z, true, there);
    ++best.gradients;
    if (there.failed || !(there.objective() <= best.objective * (1.0 + round_off))) return;
    std::swap(here, there);
    best.z = z;
    best.objective = here.objective();
    before = moved;
  }
}

bool has_derivatives(const Problem& problem) {
  return std::all_of(problem.targets().begin(), problem.targets().end(),
                     [](const Target& t) { return t.held_out || t.simulator->has_derivatives(); });
}

}  // namespace

Optimum levenberg_marquardt(const Problem& problem, const VectorXd& start,
                            const OptimiseOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Optimum best;
  best.z = clipped(start);
  Evaluation here, trial;
  problem.evaluate(best.z, true, here);
  best.gradients = 1;
  best.objective = here.objective();
  best.failed = here.failed;
  const auto note = [&] {
    best.trace.push_back({best.evaluations, best.gradients, seconds_since(begin), best.objective});
  };
  note();
  VectorXd scale = VectorXd::Zero(best.z.size());
  double mu = 1e-3, nu = 2.0;
  best.why = "evaluations";
  int small_steps = 0;
  while (best.evaluations + best.gradients < options.max_evaluations) {
    if (problem.interrupted()) {
      best.why = "interrupted";
      break;
    }
    const VectorXd g = here.J.transpose() * here.r;
    // Marquardt's scale, never shrinking (Moré 1978), with a floor for coordinates without effect
    scale = scale.cwiseMax(here.J.colwise().norm().transpose());
    const double largest = scale.maxCoeff();
    if (!(largest > 0.0) || !std::isfinite(largest)) {
      best.why = largest == 0.0 ? "nothing depends on the parameters" : "error: not finite";
      break;
    }
    const VectorXd D = scale.cwiseMax(1e-8 * largest);
    const std::vector<Index> free = movable(best.z, g, options.fixed);
    if (free.empty()) {
      best.why = "converged";
      break;
    }
    const VectorXd target = best.z + damped_step(here.J, here.r, D, free, mu, best.z);
    const VectorXd z = clipped(target);
    const VectorXd step = z - best.z;
    const double moved = step.cwiseAbs().maxCoeff();
    const double predicted = 0.5 * (here.r.squaredNorm() - (here.r + here.J * step).squaredNorm());
    if (moved < options.x_tolerance || !(predicted > 0.0)) {
      // a step cut short at a bound may be small while others would move further: free them first
      if (predicted > 0.0 || mu > 1e12 || ++small_steps > 3) {
        best.why = "converged";
        if (!(moved < options.x_tolerance)) best.why = "round-off";
        break;
      }
      mu *= nu;
      nu *= 2.0;
      continue;
    }
    problem.evaluate(z, false, trial);
    ++best.evaluations;
    const double f = trial.objective();
    const double gain = (best.objective - f) / predicted;
    if (f < best.objective) {
      const double drop = best.objective - f;
      const double before = best.objective;
      best.z = z;
      problem.evaluate(z, true, here);
      ++best.gradients;
      best.objective = here.objective();
      best.failed = here.failed;
      note();
      mu = std::max(1e-15, mu * std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gain - 1.0, 3.0)));
      nu = 2.0;
      if (drop <= options.f_tolerance * before && predicted <= options.f_tolerance * before) {
        best.why = "converged";
        break;
      }
    } else {
      mu *= nu;
      nu *= 2.0;
      if (mu > 1e20) {
        best.why = "round-off";
        break;
      }
    }
  }
  if ((best.why == "converged" || best.why == "round-off") && has_derivatives(problem))
    finish(problem, options, scale, here, best);
  best.seconds = seconds_since(begin);
  note();
  return best;
}

}  // namespace repose::calibration
