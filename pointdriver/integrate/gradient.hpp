#pragma once
/// \file
/// Derivatives of a curve with respect to the law's parameters, in plain numbers; sensitivity.hpp
/// has what they are made of.

#include "pointdriver/integrate/simulate.hpp"

namespace repose::point {

/// One quantity over the rows of a curve.
struct GradientColumn {
  std::vector<double> values;       ///< rows
  std::vector<double> derivatives;  ///< [row * which.size() + j]: to the parameter which[j]
};

/// Drives the test and reads columns[c], the quantity quantities[c] with its derivatives with
/// respect to the parameters at `which` (indices into law.parameters), each taken at the row's
/// place on the path. `theta` as given by the user: parameters that the law derives must be NaN to
/// follow the others. Status unsupported for methods other than adaptive and implicit.
Outcome simulate_columns_with_gradient(const LawInfo& law, std::span<const double> theta,
                                       std::span<const int> which, const PointTest& test,
                                       std::span<const Quantity> quantities,
                                       std::vector<GradientColumn>& columns);

}  // namespace repose::point
