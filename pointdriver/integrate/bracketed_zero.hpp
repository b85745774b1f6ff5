#pragma once
/// \file
/// Where an event happens: a zero between two times on either side of it.

#include <algorithm>
#include <cmath>

namespace repose::point {

/// A bracket of a zero: g ≤ 0 at `before`, g > 0 at `after`.
struct Bracket {
  double before, after;
  double g_before, g_after;

  double width() const { return after - before; }
  /// Mean slope over it.
  double slope() const { return (g_after - g_before) / width(); }
};

/// Narrows a bracket by Chandrupatla's method (Advances in Engineering Software 28, 1997, 145–149):
/// inverse quadratic interpolation where three values allow it, bisection elsewhere, so that a kink
/// or a jump costs time and nothing else. g(t, ok) may clear `ok`: then there is no value at t, the
/// search ends and returns false. It ends when the bracket is no wider than `width`, when no number
/// lies between its ends, or when g is 0 at `before`; and with false after 200 evaluations, four
/// times what bisection alone would need for the narrowest width that is asked for.
template <class G>
bool narrow(Bracket& b, double width, G&& g) {
  constexpr int most = 200;
  double third = b.before, g_third = b.g_before;  // the value that left the bracket last
  double share = 0.5;                             // of the way from `before`
  for (int i = 0; i < most && b.width() > width && b.g_before != 0.0; ++i) {
    const double least = std::min(0.5, 0.5 * width / b.width());
    double t = b.before + std::clamp(share, least, 1.0 - least) * b.width();
    if (!(t > b.before && t < b.after)) return true;  // neighbouring numbers
    bool ok = true;
    const double g_t = g(t, ok);
    if (!ok || std::isnan(g_t)) return false;
    if (g_t > 0.0) {
      third = b.after;
      g_third = b.g_after;
      b.after = t;
      b.g_after = g_t;
    } else {
      third = b.before;
      g_third = b.g_before;
      b.before = t;
      b.g_before = g_t;
    }
    // x_1 the newest end, x_2 the other, x_3 the one that left
    const bool newest_after = g_t > 0.0;
    const double x1 = t, g1 = g_t;
    const double x2 = newest_after ? b.before : b.after;
    const double g2 = newest_after ? b.g_before : b.g_after;
    const double xi = (x1 - x2) / (third - x2);
    const double phi = (g1 - g2) / (g_third - g2);
    double from_newest = 0.5;
    if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi)
      from_newest = g1 / (g2 - g1) * g_third / (g2 - g_third) +
                    (third - x1) / (x2 - x1) * g1 / (g_third - g1) * g2 / (g_third - g2);
    share = newest_after ? 1.0 - from_newest : from_newest;
    if (!(share >= 0.0 && share <= 1.0)) share = 0.5;
  }
  return b.width() <= width || b.g_before == 0.0;
}

}  // namespace repose::point
