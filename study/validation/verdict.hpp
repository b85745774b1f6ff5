#pragma once
/// \file
/// What a computed figure is worth against what was measured.

#include <array>
#include <cmath>
#include <span>
#include <string_view>

namespace repose::study {

enum class Verdict : unsigned char {
  inside,     ///< the value with its error bar lies in the band
  outside,    ///< and beside it
  undecided,  ///< the error bar reaches across an end of the band
  failed,     ///< there is no value
  absent,     ///< the case has no such law
  not_run,    ///< it was not asked for
};
/// Their names, in the same order.
constexpr std::array<std::string_view, 6> verdict_names{"inside", "outside", "undecided",
                                                        "failed", "absent",  "not run"};
constexpr std::string_view name_of(Verdict verdict) {
  return verdict_names[static_cast<std::size_t>(verdict)];
}

/// A value and how far it may be off; the bar is NaN where nothing tells.
struct Estimated {
  double value = std::nan(""), error = std::nan("");
};

/// inside, outside or undecided; by the value alone where there is no bar. least: the least that
/// the value can be, 0 for a distance, below which no bar reaches.
Verdict judge(const Estimated& estimated, const std::array<double, 2>& band,
              double least = -HUGE_VAL);

/// What runs with cells h, coarse to fine, tend to: own_estimate() (study/accuracy/own_runs.hpp) of
/// three sizes that are each 1.9 times as coarse as the next, else close_estimate() of three that
/// are 1.3 times as coarse, else the finest with three times the change; no bar for one size.
/// Shifting all values shifts the result.
Estimated estimate_of_sizes(std::span<const double> h, std::span<const double> values);

}  // namespace repose::study
