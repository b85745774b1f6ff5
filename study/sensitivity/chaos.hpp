#pragma once
/// \file
/// A polynomial in place of an output, and the shares of variance that its coefficients are
/// (Sudret 2008).

#include <span>

#include "study/sensitivity/sobol.hpp"

namespace repose::study {

/// The polynomials that are orthonormal for an input: Legendre's in 2u − 1, or Hermite's in the
/// standard normal variable with P = u.
enum class Orthonormal : std::uint8_t { legendre, hermite };

/// y ≈ Σ_α c_α Π_j ψ_{α_j}(u_j), by least squares.
class PolynomialChaos {
 public:
  /// u: a point in the unit cube per row; y: the outputs there, all finite. Of all terms with
  /// (Σ α_j^q)^(1/q) ≤ p (Blatman & Sudret 2010), q of 1, 0.75 and 0.5 and p from 1 to 20, those
  /// with the least error in the points left out are taken, at most half as many as points.
  /// Errors: std::invalid_argument for fewer than 2 (inputs + 1) points.
  PolynomialChaos(const Eigen::MatrixXd& u, std::span<const Orthonormal> families,
                  const Eigen::VectorXd& y);

  double operator()(const Eigen::VectorXd& u) const;

  int degree() const { return degree_; }
  double norm() const { return norm_; }  ///< q
  Eigen::Index terms() const { return c_.size(); }
  double mean() const { return c_[0]; }
  double variance() const { return c_.tail(c_.size() - 1).squaredNorm(); }
  /// 1 − (mean square of what each point misses when it is left out, from the hat matrix, times
  /// n/(n − P) (1 + tr (ΨᵀΨ)⁻¹), for few points: Chapelle, Vapnik & Bengio 2002) / variance. 1:
  /// exact.
  double q2() const { return q2_; }

  /// Intervals: of least squares on values with the errors of the points left out, drawn anew, so
  /// that they hold what the polynomial misses.
  std::vector<VarianceShares> shares(std::uint64_t seed) const;

 private:
  /// Values of all terms at u.
  Eigen::RowVectorXd terms_at(const Eigen::VectorXd& u) const;
  Eigen::VectorXd shares_of(const Eigen::VectorXd& c) const;

  std::vector<Orthonormal> families_;
  std::vector<std::vector<int>> powers_;  ///< α of each term; the first is the constant
  Eigen::VectorXd c_;
  Eigen::MatrixXd inverse_;  ///< (ΨᵀΨ)⁻¹Ψᵀ
  Eigen::VectorXd left_out_;
  int degree_ = 0;
  double norm_ = 1.0, q2_ = 0.0;
};

}  // namespace repose::study
