#pragma once
/// \file
/// Derivatives against central differences.

#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace repose {

/// Compares a derivative with central differences of f at steps h and h/2, and counts the
/// comparisons whose tolerance is below 1e-5 of `size`: the others say nothing.
///
/// A central difference D(h) errs by truncation, of which (4/3)|D(h) − D(h/2)| is an estimate that
/// fails only where the fourth-order term rules, and by round-off, noise/h. Both make the
/// tolerance.
struct Comparison {
  int sharp = 0;
  int all = 0;

  void operator()(double derivative, double f_plus, double f_minus, double f_half_plus,
                  double f_half_minus, double h, double noise, double size,
                  const std::string& what) {
    const double whole = (f_plus - f_minus) / (2.0 * h);
    const double half = (f_half_plus - f_half_minus) / h;
    const double tolerance = 4.0 / 3.0 * std::abs(whole - half) + 4.0 * noise / h;
    EXPECT_NEAR(derivative, half, tolerance) << what;
    ++all;
    if (tolerance < 1e-5 * size) ++sharp;
  }
};

}  // namespace repose
