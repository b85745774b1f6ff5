#include "calibration/quantiles.hpp"

#include <algorithm>
#include <cmath>

namespace repose::calibration {
namespace {

/// Regularised incomplete beta function I_x(a, b) by its continued fraction (Abramowitz & Stegun
/// 26.5.8), evaluated by Lentz's method.
double incomplete_beta(double a, double b, double x) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  if (x > (a + 1.0) / (a + b + 2.0)) return 1.0 - incomplete_beta(b, a, 1.0 - x);
  const auto guarded = [](double y) { return std::abs(y) < 1e-300 ? 1e-300 : y; };
  double c = 1.0, d = 1.0 / guarded(1.0 - (a + b) * x / (a + 1.0)), f = d;
  for (int m = 1; m < 500; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1.0 / guarded(1.0 + even * d);
    c = guarded(1.0 + even / c);
    f *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1.0 / guarded(1.0 + odd * d);
    c = guarded(1.0 + odd / c);
    f *= c * d;
    if (std::abs(c * d - 1.0) < 1e-15) break;
  }
  const double front =
      std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x);
  return std::exp(front) * f / a;
}

/// Root of a rising function in [low, high].
template <class F>
double bisect(F&& f, double low, double high) {
  for (int i = 0; i < 100 && high - low > 1e-13 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double normal_quantile(double probability) {
  const double tail = std::min(probability, 1.0 - probability);
  const double x =
      bisect([&](double y) { return tail - 0.5 * std::erfc(y / std::sqrt(2.0)); }, 0.0, 40.0);
  return probability < 0.5 ? -x : x;
}

double t_probability(double t, double freedom) {
  if (!(freedom < 1e7)) return 0.5 * std::erfc(-t / std::sqrt(2.0));
  const double tail = 0.5 * incomplete_beta(0.5 * freedom, 0.5, freedom / (freedom + t * t));
  return t > 0.0 ? 1.0 - tail : tail;
}

double t_quantile(double freedom) {
  const double n = freedom > 1.0 ? freedom : 1.0;
  return bisect([&](double t) { return t_probability(t, n) - 0.975; }, 1.9, 13.0);
}

double mixed_freedom(double freedom, double scatter) {
  if (!(scatter > 1e-12)) return std::max(1.0, freedom);
  const double root = std::sqrt(scatter);
  // the trapezoidal rule over the normal density: its error falls faster than any power of the step
  constexpr double step = 0.5;
  const auto probability = [&](double q) {
    double sum = 0.0, weight = 0.0;
    for (int k = -12; k <= 12; ++k) {
      const double w = std::exp(-0.5 * std::pow(step * k, 2));
      sum += w * t_probability(q * std::exp(0.5 * root * step * k), freedom);
      weight += w;
    }
    return sum / weight;
  };
  const double q = bisect([&](double t) { return probability(t) - 0.975; }, 1.9, 13.0);
  // t falls with the degrees of freedom, rises with their inverse
  const double inverse =
      bisect([&](double x) { return 0.975 - t_probability(q, 1.0 / x); }, 1e-9, 1.0);
  return 1.0 / inverse;
}

double critical_excess(double freedom, double below_it, double above_it) {
  const double n = freedom > 1.0 ? freedom : 1.0;
  const double t = t_quantile(n);
  if (below_it >= t && above_it >= t) return t * t;
  // an estimate that stops at a bound d away leaves the excess 2 d |Z| − d² instead of Z²
  const auto reach = [](double excess, double d) {
    if (!(excess > d * d)) return std::sqrt(excess);
    return d > 0.0 ? (excess + d * d) / (2.0 * d) : 1e300;
  };
  const double low = std::max(0.0, below_it), high = std::max(0.0, above_it);
  return bisect(
      [&](double excess) {
        return t_probability(reach(excess, high), n) - t_probability(-reach(excess, low), n) - 0.95;
      },
      0.0, t * t);
}

}  // namespace repose::calibration
