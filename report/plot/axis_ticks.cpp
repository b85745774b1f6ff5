#include "report/plot/axis_ticks.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace repose::report {

namespace {

std::string fixed(double value, int decimals) {
  const std::string digits = fmt::format("{:.{}f}", std::abs(value), decimals);
  const bool zero = digits.find_first_not_of("0.") == std::string::npos;
  return value < 0.0 && !zero ? "−" + digits : digits;
}

/// The decimals that a number needs to show a step of 1, 2 or 5 times a power of ten.
int decimals_of(double step) {
  // The small addition keeps 0.1, stored a little above or below, on the right side of floor.
  return std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
}

/// 1, 2 or 5 times a power of ten, such that the length holds at most `target` such steps.
double nice_step(double length, int target) {
  const double least = length / std::max(target, 1);
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least * (1.0 - 1e-9)) return factor * power;
  return 10.0 * power;
}

std::string power_of_ten(int exponent) {
  return exponent < 0 ? fmt::format("10^{{−{}}}", -exponent) : fmt::format("10^{{{}}}", exponent);
}

/// A number for a tick of its own: 0.05, 200, 3×10^{6}.
std::string plain(double value) {
  const int exponent = static_cast<int>(std::floor(std::log10(value) + 1e-9));
  if (exponent >= 5 || exponent <= -4) {
    const double mantissa = value / std::pow(10.0, exponent);
    const std::string power = power_of_ten(exponent);
    return std::abs(mantissa - 1.0) < 1e-6 ? power : fmt::format("{:g}×{}", mantissa, power);
  }
  return fmt::format("{:g}", value);
}

/// What is left where no step fits.
std::vector<Tick> ends(double lower, double upper) {
  std::vector<Tick> ticks;
  for (const double value : {lower, upper})
    if (std::isfinite(value) && (ticks.empty() || value != ticks.back().value))
      ticks.push_back({value, fmt::format("{:.4g}", value), false});
  return ticks;
}

}  // namespace

std::vector<Tick> linear_ticks(double lower, double upper, int target) {
  const double largest = std::max(std::abs(lower), std::abs(upper));
  // Steps are counted in doubles: below 2⁻⁴⁰ of the largest value a count has no room for 1e-9.
  if (!(upper - lower > 1e-12 * largest) || !std::isfinite(upper - lower))
    return ends(lower, upper);
  double step = nice_step(upper - lower, target);
  const auto first_of = [&](double s) { return std::ceil(lower / s - 1e-9); };
  const auto last_of = [&](double s) { return std::floor(upper / s + 1e-9); };
  // From 1, 2, 5 to the next smaller of them: 0.39 lies below each ratio and above the one after.
  for (int k = 0; k < 4 && last_of(step) - first_of(step) < 1.0; ++k)
    step = nice_step(step * 0.39, 1);
  const double count = last_of(step) - first_of(step);
  if (!(count >= 1.0 && count < 1000.0)) return ends(lower, upper);

  const int exponent = static_cast<int>(std::floor(std::log10(largest) + 1e-9));
  const bool scientific = exponent >= 5 || exponent <= -4;
  const double unit = scientific ? std::pow(10.0, exponent) : 1.0;
  const int decimals = decimals_of(step / unit);
  std::vector<Tick> ticks;
  for (int i = 0; i <= static_cast<int>(count); ++i) {
    const double k = first_of(step) + i;
    const double value = k * step;
    std::string label = fixed(value / unit, decimals);
    if (scientific) label = k == 0.0 ? "0" : label + "×" + power_of_ten(exponent);
    ticks.push_back({value, std::move(label), false});
  }
  return ticks;
}

std::vector<Tick> logarithmic_ticks(double lower, double upper, int target) {
  const int first = static_cast<int>(std::floor(std::log10(lower) - 1e-9));
  const int last = static_cast<int>(std::ceil(std::log10(upper) + 1e-9));
  const auto inside = [&](double value) {
    return value >= lower * (1.0 - 1e-9) && value <= upper * (1.0 + 1e-9);
  };
  int powers = 0, short_axis_labels = 0;
  for (int k = first; k <= last; ++k)
    for (const double factor : {1.0, 2.0, 5.0})
      if (inside(factor * std::pow(10.0, k))) {
        ++short_axis_labels;
        if (factor == 1.0) ++powers;
      }
  const bool short_axis = powers < 3;
  // Less than a factor of about two: the axis is nearly linear.
  if (short_axis && short_axis_labels < 2) return linear_ticks(lower, upper, target);

  const int stride = std::max(1, (powers + target - 1) / std::max(target, 1));
  std::vector<Tick> ticks;
  for (int k = first; k <= last; ++k)
    for (int factor = 1; factor <= 9; ++factor) {
      const double value = factor * std::pow(10.0, k);
      if (!inside(value)) continue;
      const bool labelled =
          short_axis ? factor == 1 || factor == 2 || factor == 5 : factor == 1 && k % stride == 0;
      // With several decades between two labels, the ticks in between would be a grey bar.
      if (!labelled && factor != 1 && stride > 1) continue;
      const std::string label = short_axis ? plain(value) : power_of_ten(k);
      ticks.push_back({value, labelled ? label : "", !labelled});
    }
  return ticks;
}

}  // namespace repose::report
