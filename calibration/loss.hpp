#pragma once
/// \file
/// What a residual costs: its square, or less where it is large, so that a few rows that are wrong
/// do not pull the fit.
///
/// With u = r/s, s the scale of the channel's good rows, a row costs s² ρ(u):
///   normal   ρ = u²/2
///   Huber    ρ = u²/2 up to |u| = k, k|u| − k²/2 beyond (Huber 1981, §4.5); k = 1.345: 95 % of the
///            efficiency of least squares where errors are normal after all
///   Student  ρ = (ν + 1)/2 ln(1 + u²/ν), ν = 4: errors with Student's t distribution (Lange,
///   Little
///            & Taylor, J. Am. Stat. Assoc. 84 (1989) 881)
/// Each is concave in u², so that for a row of weight w = ρ'(u)/u the parabola w r²/2 + const,
/// which touches the cost at the present r, lies nowhere below it: a step that lowers the weighted
/// sum of squares lowers the cost by at least as much (iteratively reweighted least squares).

#include <cstdint>
#include <string_view>

#include <Eigen/Core>

namespace repose::calibration {

enum class Residuals : std::uint8_t { normal, huber, student };

struct Loss {
  Residuals residuals = Residuals::normal;
  /// k or ν; see usual_tuning().
  double tuning = 0.0;

  bool robust() const { return residuals != Residuals::normal; }
  double cost(double u) const;    ///< ρ
  double score(double u) const;   ///< ψ = ρ'
  double weight(double u) const;  ///< ψ/u, ψ' at 0
  double slope(double u) const;   ///< ψ'
};
/// 1.345 of Huber's, 4 of Student's.
double usual_tuning(Residuals residuals);

/// 1.4826 times the median of |r| (of normal errors about 0: their standard deviation); their
/// r.m.s. where half of them and more are 0.
double median_scale(const Eigen::VectorXd& r);

/// The scale of residuals r that belongs to a loss, `least` at least, from `from` on: Huber's
/// Proposal 2 (1981, §6.7), Σ ψ(u)² = f E ψ² of standard normal u with f = n − used; Student's
/// most likely one, Σ w(u) u² = n (Lange et al. 1989). The fixed point is reached by turns, of
/// which each lowers Σ s (ρ(u) + E ψ²/2 · f/n) of Huber's and n ln s + Σ ρ(u) of Student's.
double settled_scale(const Loss& loss, const Eigen::VectorXd& r, double used, double from,
                     double least);

}  // namespace repose::calibration
