#pragma once
/// \file
/// Derivatives of a curve with respect to the law's parameters.
///
/// simulate_with_gradient drives the test in dual numbers, through `adaptive` or `implicit`: every
/// row carries its derivatives, taken at the row's place on the path (equal share of each leg). The
/// kink at yield is exact because the time of yield carries derivatives as well. Initial state and
/// derived parameters (p_c, v from Γ, G = 4K) contribute through differences of the law's own
/// initial(), extrapolated to about 1e-11.
///
/// cvodes_gradient integrates the sensitivity equations with CVODES instead and adds the jump
///     s⁺ = s⁻ + (f⁻ − f⁺) dt*/dθ,   dt*/dθ = −(F_y·s⁻ + F_θ)/(F_y·f⁻)
/// at yield; it serves as an independent check.

#include "models/dual.hpp"
#include "pointdriver/integrate/simulate.hpp"

namespace repose::point {

/// Parameters differentiated in one pass.
inline constexpr int gradient_width = 6;
using Gradient = Dual<gradient_width>;
using GradientCurve = BasicCurve<Gradient>;

/// Drives the test with derivatives with respect to the parameters at `which` (indices into
/// law.parameters; at most gradient_width, more need several passes). `theta` as given by the user:
/// parameters that the law derives must be NaN to follow the others. Status unsupported for methods
/// other than adaptive and implicit. Throws InputError (key "name") for a law that is unknown or
/// was registered without a point driver.
Outcome simulate_with_gradient(const LawInfo& law, std::span<const double> theta,
                               std::span<const int> which, const PointTest& test,
                               GradientCurve& curve);

/// One quantity off every row: values[row], and derivatives[row * which.size() + j].
void read_column_with_gradient(const LawInfo& law, std::span<const double> theta,
                               std::span<const int> which, const PointTest& test,
                               const GradientCurve& curve, Quantity quantity,
                               std::vector<double>& values, std::vector<double>& derivatives);

/// Rows of a strain-rate or mixed control test by CVODES with forward sensitivities with respect to
/// `parameter`: the stress and its derivative at each row. One leg that ends on time, laws with a
/// yield surface only, of the library alone: throws InputError (key "name") for another.
struct CvodesRow {
  double time;
  Sym<double, 6> stress, derivative;
};
Status cvodes_gradient(const LawInfo& law, std::span<const double> theta, int parameter,
                       const PointTest& test, std::vector<CvodesRow>& rows);

}  // namespace repose::point
