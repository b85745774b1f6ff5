#include "study/accuracy/richardson.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace repose::study {
namespace {

using Eigen::VectorXd;

double size_of(const VectorXd& v) { return v.lpNorm<1>(); }

}  // namespace

double relative_distance(const VectorXd& a, const VectorXd& b) {
  return size_of(a - b) / size_of(b);
}

VectorXd Resolution::mean() const {
  VectorXd sum = VectorXd::Zero(runs.front().size());
  for (const VectorXd& run : runs) sum += run;
  return sum / static_cast<double>(runs.size());
}

double Resolution::scatter() const {
  if (runs.size() < 2) return std::nan("");
  const VectorXd centre = mean();
  double squares = 0.0;
  for (const VectorXd& run : runs) squares += std::pow(relative_distance(run, centre), 2);
  return std::sqrt(squares / static_cast<double>(runs.size() - 1));
}

double richardson_weight(double h_coarse, double h_fine, double order) {
  return 1.0 / std::expm1(order * std::log(h_coarse / h_fine));
}

double observed_order(const Resolution& coarse, const Resolution& middle, const Resolution& fine) {
  const VectorXd middle_mean = middle.mean();
  const double first = size_of(coarse.mean() - middle_mean);
  const double second = size_of(middle_mean - fine.mean());
  // (h_c^p − h_m^p)/(h_m^p − h_f^p) = first/second; the left side grows with p
  const auto ratio = [&](double p) {
    return std::pow(middle.h / fine.h, p) * richardson_weight(middle.h, fine.h, p) /
           richardson_weight(coarse.h, middle.h, p);
  };
  double lower = 0.01, upper = 10.0;
  const double wanted = first / second;
  if (!(wanted >= ratio(lower)) || !(wanted <= ratio(upper))) return std::nan("");
  for (int k = 0; k < 60; ++k) {
    const double p = 0.5 * (lower + upper);
    (ratio(p) < wanted ? lower : upper) = p;
  }
  return 0.5 * (lower + upper);
}

Reference extrapolated_reference(std::span<const Resolution> levels) {
  if (levels.size() < 3)
    throw std::invalid_argument("an extrapolated reference needs three cell sizes");
  std::vector<std::size_t> chosen{levels.size() - 1};
  for (std::size_t k = levels.size() - 1; k-- > 0 && chosen.size() < 3;)
    if (levels[k].h >= 1.9 * levels[chosen.back()].h) chosen.push_back(k);
  if (chosen.size() < 3) chosen = {levels.size() - 1, levels.size() - 2, levels.size() - 3};
  const Resolution &coarse = levels[chosen[2]], &middle = levels[chosen[1]],
                   &fine = levels[chosen[0]];
  Reference reference;
  reference.sizes = {coarse.h, middle.h, fine.h};
  reference.observed = observed_order(coarse, middle, fine);
  reference.order =
      std::isfinite(reference.observed) ? std::clamp(reference.observed, 0.5, 2.0) : 1.0;
  const VectorXd u = fine.mean(), change = u - middle.mean();
  const double w = richardson_weight(middle.h, fine.h, reference.order);
  const double w_1 = richardson_weight(middle.h, fine.h, 1.0);
  reference.value = u + w * change;
  const double size = size_of(reference.value);
  const double extrapolated = 0.25 * w * size_of(change) / size;
  const double of_order = std::abs(w - w_1) * size_of(change) / size;
  const auto of_mean = [](const Resolution& level) {
    const double s = level.scatter();
    return std::isfinite(s) ? s / std::sqrt(static_cast<double>(level.runs.size())) : 0.0;
  };
  const double scatter = std::hypot((1.0 + w) * of_mean(fine), w * of_mean(middle));
  reference.error = std::hypot(extrapolated, of_order, scatter);
  return reference;
}

}  // namespace repose::study
