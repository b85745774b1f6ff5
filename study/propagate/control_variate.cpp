#include "study/propagate/control_variate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/convergence.hpp"

namespace repose::study {

using Eigen::Index;

Propagated propagated(const Eigen::VectorXd& coarse, const std::vector<Index>& places,
                      const Eigen::VectorXd& fine, std::vector<double>* values) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  // of Eigen's own memory, whose place decides no sum's order
  Eigen::VectorXd all(coarse.size()), c(fine.size()), f(fine.size());
  Propagated p;
  for (const double x : coarse)
    if (std::isfinite(x)) all[p.draws++] = x;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double x = coarse[places[i]], y = fine[static_cast<Index>(i)];
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    c[p.pairs] = x;
    f[p.pairs++] = y;
  }
  all.conservativeResize(p.draws);
  c.conservativeResize(p.pairs);
  f.conservativeResize(p.pairs);
  if (values != nullptr) values->clear();
  if (p.pairs < fewest_pairs) {
    p.correlation = p.mean = p.standard_error = p.deviation = p.median = nan;
    p.interval_90 = {nan, nan};
    p.coarse_mean = p.change = p.worth = nan;
    return p;
  }
  const auto N = static_cast<double>(p.draws), n = static_cast<double>(p.pairs);
  p.coarse_mean = all.mean();
  const double mean_c = c.mean(), mean_f = f.mean();
  const Eigen::VectorXd dc = c.array() - mean_c, df = f.array() - mean_f;
  const double S_cc = dc.squaredNorm(), S_ff = df.squaredNorm(), S_cf = dc.dot(df);
  // coarse runs that are alike to round-off tell nothing of the fine ones
  const double tiny = 1e-12 * std::max(std::abs(mean_c), std::abs(mean_f));
  const bool tells = S_cc > n * tiny * tiny;
  const double b = tells ? S_cf / S_cc : 0.0;
  p.correlation = tells && S_ff > 0.0 ? S_cf / std::sqrt(S_cc * S_ff) : 0.0;
  Eigen::VectorXd e = df - b * dc;
  const double s2 = e.squaredNorm() / (n - 2.0);
  const double off = p.coarse_mean - mean_c;
  const double s2_c = (all.array() - p.coarse_mean).square().sum() / (N - 1.0);
  p.mean = mean_f + b * off;
  p.standard_error = std::sqrt(s2 / n + (tells ? s2 * off * off / S_cc : 0.0) + b * b * s2_c / N);
  p.deviation = std::sqrt(b * b * s2_c + s2);
  p.change = p.mean - p.coarse_mean;
  p.worth = p.standard_error > 0.0 ? std::pow(p.deviation / p.standard_error, 2) : n;
  e *= std::sqrt(n / (n - 2.0));  // their mean square is s²
  Eigen::VectorXd sums(p.draws * p.pairs);
  for (Index j = 0; j < p.draws; ++j)
    sums.segment(j * p.pairs, p.pairs) = e.array() + (mean_f + b * (all[j] - mean_c));
  std::sort(sums.begin(), sums.end());
  const auto quantile = [&](double q) { return calibration::sample_quantile(sums, q); };
  p.median = quantile(0.5);
  p.interval_90 = {quantile(0.05), quantile(0.95)};
  if (values != nullptr) values->assign(sums.begin(), sums.end());
  return p;
}

}  // namespace repose::study
