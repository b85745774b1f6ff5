#pragma once
/// \file
/// A path with first derivatives to parameters and initial conditions: dual numbers through the
/// whole integration, so that yield and every end of a stage are differentiated where they lie.

#include <Eigen/Core>

#include "pointdriver/integrate/simulate.hpp"

namespace repose::calibration {

/// Parameters of a law (NaN where absent) and the scalar initial conditions, as one input vector.
struct PointInputs {
  std::vector<double> theta;
  InitialConditions initial;
};

/// One quantity over the rows of a curve and its derivatives (rows × wanted).
struct Column {
  Eigen::VectorXd value;
  Eigen::MatrixXd slope;
};

/// Positions of the initial conditions behind the law's parameters in an input vector.
enum InitialInput : int { input_p, input_ocr, input_v, input_K0, input_p_c0 };
inline constexpr int initial_input_count = 5;
inline constexpr std::array<std::string_view, initial_input_count> initial_input_names{
    "p", "ocr", "v", "K0", "p_c0"};

/// Splits an input vector (law parameters, then initial_input_names; NaN where absent); p_c0 turns
/// into ocr = p_c0/p.
PointInputs split_inputs(std::size_t parameters, const InitialConditions& fixed,
                         std::span<const double> inputs);

/// Drives `test` with derivatives to the inputs `wanted`; columns[c] is quantities[c] over the
/// rows, legs[i] the leg of row i. The test's method must be adaptive or implicit. The derivatives
/// of the initial state, closed formulas of the inputs, are taken by central differences (relative
/// error 1e-10); those of the path are exact.
point::Outcome simulate_with_derivatives(const LawInfo& law, const InitialConditions& fixed,
                                         std::span<const double> inputs,
                                         std::span<const int> wanted, const point::PointTest& test,
                                         std::span<const point::Quantity> quantities,
                                         std::vector<Column>& columns, std::vector<int>& legs);

}  // namespace repose::calibration
