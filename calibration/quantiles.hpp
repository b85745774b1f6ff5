#pragma once
/// \file
/// Quantiles of the normal distribution and of Student's t for any degrees of freedom, and how far
/// a likelihood may fall beside a bound.

namespace repose::calibration {

/// The x of P(X ≤ x) = probability, 0 < probability < 1, of the standard normal distribution.
double normal_quantile(double probability);

/// P(T ≤ t); an infinite freedom is the normal distribution.
double t_probability(double t, double freedom);

/// Student's t, two-sided 95 %: P(|T| ≤ t) = 0.95. Less than one degree of freedom counts as one.
double t_quantile(double freedom);

/// Degrees of freedom whose Student's t is the two-sided 95 % quantile of Z/√(u v), Z normal, u a
/// χ² of `freedom` over that, and ln v normal of mean 0 and variance `scatter`: a variance known
/// from a sum of squares and from a correlation. At least 1.
double mixed_freedom(double freedom, double scatter);

/// The excess of the misfit (twice the objective's rise over its variance) up to which a value
/// belongs to the 95 % interval, if the truth at that value lies `below_it` standard errors above a
/// lower bound and `above_it` below an upper one. Away from bounds t², at a bound the square of the
/// one-sided quantile: an estimate that cannot pass the bound errs less often on that side
/// (Feldman & Cousins 1998; docs/fitting.md derives it).
double critical_excess(double freedom, double below_it, double above_it);

}  // namespace repose::calibration
