#pragma once

#include <string>
#include <vector>

namespace repose::report {

/// A mark on an axis; minor ones are short and have no label.
/// label: for gnuplot_text(), with a real minus sign and 10^{-3} for powers of ten.
struct Tick {
  double value = 0.0;
  std::string label;
  bool minor = false;
};

/// Ticks at 1, 2 or 5 times a power of ten within [lower, upper], at most about `target` of them
/// and at least two. Large and small numbers share one power of ten: 2×10^{5}. A range so narrow
/// that its ends differ in the last few bits only, or that is empty or not finite, has a tick at
/// each end that is finite.
std::vector<Tick> linear_ticks(double lower, double upper, int target);

/// Ticks of a logarithmic axis: the powers of ten, with 2 to 9 times them as minor ticks; labels at
/// 1, 2 and 5 times a power where the axis is short. Requires finite 0 < lower < upper.
std::vector<Tick> logarithmic_ticks(double lower, double upper, int target);

}  // namespace repose::report
