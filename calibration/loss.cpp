#include "calibration/loss.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace repose::calibration {
namespace {

using Eigen::VectorXd;

/// E ψ(u)² of Huber's ψ and standard normal u: ∫ min(u², k²).
double mean_square_score(double k) {
  const double inside = std::erf(k / std::sqrt(2.0));  // P(|u| < k)
  const double density = std::exp(-0.5 * k * k) / std::sqrt(2.0 * 3.14159265358979323846);
  return inside - 2.0 * k * density + k * k * (1.0 - inside);
}

}  // namespace

double usual_tuning(Residuals residuals) { return residuals == Residuals::huber ? 1.345 : 4.0; }

double Loss::cost(double u) const {
  const double a = std::abs(u);
  if (residuals == Residuals::huber && a > tuning) return tuning * (a - 0.5 * tuning);
  if (residuals == Residuals::student) return 0.5 * (tuning + 1.0) * std::log1p(u * u / tuning);
  return 0.5 * u * u;
}

double Loss::weight(double u) const {
  const double a = std::abs(u);
  if (residuals == Residuals::huber && a > tuning) return tuning / a;
  if (residuals == Residuals::student) return (tuning + 1.0) / (tuning + u * u);
  return 1.0;
}

double Loss::score(double u) const { return weight(u) * u; }

double Loss::slope(double u) const {
  if (residuals == Residuals::huber) return std::abs(u) > tuning ? 0.0 : 1.0;
  if (residuals == Residuals::student)
    return (tuning + 1.0) * (tuning - u * u) / std::pow(tuning + u * u, 2);
  return 1.0;
}

double median_scale(const VectorXd& r) {
  std::vector<double> sizes(r.begin(), r.end());
  for (double& x : sizes) x = std::abs(x);
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  double median = *middle;
  if (sizes.size() % 2 == 0) median = 0.5 * (median + *std::max_element(sizes.begin(), middle));
  if (median > 0.0) return 1.4826 * median;
  return std::sqrt(r.squaredNorm() / static_cast<double>(r.size()));
}

double settled_scale(const Loss& loss, const VectorXd& r, double used, double from, double least) {
  const auto n = static_cast<double>(r.size());
  const bool huber = loss.residuals == Residuals::huber;
  const double wanted = huber ? std::max(n - used, 0.5) * mean_square_score(loss.tuning) : n;
  double s = std::max(from, least);
  for (int turn = 0; turn < 1000; ++turn) {
    double sum = 0.0;
    for (const double x : r) {
      const double u = x / s;
      sum += huber ? std::pow(loss.score(u), 2) : loss.score(u) * u;
    }
    const double next = std::max(s * std::sqrt(sum / wanted), least);
    const bool settled = std::abs(next - s) <= 1e-12 * s;
    s = next;
    if (settled) break;
  }
  return s;
}

}  // namespace repose::calibration
