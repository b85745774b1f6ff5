#pragma once
/// \file
/// Runs at several resolutions against what they tend to (Richardson 1911): observed order,
/// extrapolated value and its error bar, where runs also scatter.
///
/// A quantity is a vector of shares: one number, or a curve as its values times their widths, so
/// that |u|₁ = Σ|u_i| is the number's size or the area under the curve. Errors are relative,
/// |u − u*|₁/|u*|₁.

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace repose::study {

/// |a − b|₁/|b|₁.
double relative_distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

/// The runs at one cell size that differ in nothing that should matter (steps close to each other).
struct Resolution {
  double h = 0.0;                     ///< cell size [m]
  std::vector<Eigen::VectorXd> runs;  ///< at least one

  Eigen::VectorXd mean() const;
  /// Standard deviation of one run, relative to the mean; NaN for a single run.
  double scatter() const;
};

/// p of u(h) = u* + c h^p from the means at three cell sizes, coarse to fine; the sizes need not
/// have a common ratio (Celik et al. 2008, solved by bisection in [0.01, 10]). NaN where the
/// changes do not shrink.
double observed_order(const Resolution& coarse, const Resolution& middle, const Resolution& fine);

/// 1/(r^p − 1), r = h_coarse/h_fine: the share of the last change that is still to come.
double richardson_weight(double h_coarse, double h_fine, double order);

/// What a sequence of resolutions tends to.
struct Reference {
  std::array<double, 3> sizes{};  ///< the cells it is from
  Eigen::VectorXd value;
  double order = 0.0;     ///< used: the observed one within [0.5, 2], or 1 where there is none
  double observed = 0.0;  ///< observed_order() of the three finest; may be NaN
  double error = 0.0;     ///< error bar of `value`, relative, one standard deviation
};

/// From at least three cell sizes, coarse to fine. Three count: the finest, and each time the
/// finest that is at least 1.9 times as coarse (where there are none, the three finest). The error
/// bar is the root of the squares of three parts: a quarter of what has been extrapolated (the grid
/// convergence index of Roache 1994, 1.25 |u_f − u*|, less the extrapolation itself), the change of
/// u* where the order is 1 instead, and the scatter of the means carried through. Throws
/// std::invalid_argument for fewer.
Reference extrapolated_reference(std::span<const Resolution> levels);

}  // namespace repose::study
