#pragma once
/// \file
/// What a fit may change: named values with bounds and scale, and the coordinates z in [0, 1]^n in
/// which every optimiser works.
///
///   linear   x = lower + z (upper − lower)
///   log      x = lower (upper/lower)^z
/// A parameter may be given as a ratio to another, value = x · value(other), or be kept below
/// another, upper = min(upper, 0.999 value(other)): both keep κ < λ for every z, the second within
/// bounds of the values themselves.

#include <array>
#include <vector>

#include <Eigen/Core>

#include "calibration/free_parameter.hpp"

namespace repose::calibration {

class ParameterSpace {
 public:
  ParameterSpace() = default;
  /// Errors: InputError (key = the parameter's name) for bounds that are not finite or not in
  /// order, log bounds that are not positive, a start outside its bounds, a ratio to a later
  /// parameter, an order that the bounds leave no room for, a prior without sd > 0.
  explicit ParameterSpace(std::vector<FreeParameter> parameters);

  std::size_t size() const { return parameters_.size(); }
  const FreeParameter& operator[](std::size_t i) const { return parameters_[i]; }
  const std::vector<FreeParameter>& parameters() const { return parameters_; }

  /// Values of the parameters at z (n).
  Eigen::VectorXd values(const Eigen::VectorXd& z) const;
  /// ∂value_i/∂z_j (n × n), lower triangular up to order.
  Eigen::MatrixXd slopes(const Eigen::VectorXd& z) const;
  /// z of given values, not clipped. Values whose logarithm is needed must be positive.
  Eigen::VectorXd coordinates(const Eigen::VectorXd& values) const;
  /// z of the starting values, clipped into the cube.
  Eigen::VectorXd start() const;

  /// What a value can be within all bounds, those of its partner included.
  std::array<double, 2> reach(std::size_t i) const;
  /// This space with the value of one parameter held: its coordinate does nothing, and its partner
  /// keeps to what is left of its bounds. Nothing if the value is out of reach.
  std::optional<ParameterSpace> held(std::size_t i, double value) const;
  /// This space with other means of the priors, in the order of the parameters that have one.
  ParameterSpace with_prior_means(const Eigen::VectorXd& means) const;
  /// The k-th point of a low-discrepancy sequence (Halton 1960 with a random shift by `seed`,
  /// Cranley & Patterson 1976); the same (k, seed) gives the same point.
  Eigen::VectorXd spread_point(std::size_t k, std::uint64_t seed) const;

  std::size_t prior_count() const;
  /// Residuals of the priors and, if J is given (prior_count × n), their derivatives to z.
  void priors(const Eigen::VectorXd& z, Eigen::Ref<Eigen::VectorXd> r,
              Eigen::Ref<Eigen::MatrixXd>* J) const;
  /// ln of the prior density of z, without its constant: even in z where a parameter has no prior,
  /// and with one that distribution of its value (given those of earlier parameters), cut off at
  /// the bounds: ln p = −½ r² + ln |∂value/∂z|. gradient: n.
  double log_prior(const Eigen::VectorXd& z, Eigen::VectorXd& gradient) const;
  /// Gauss-Newton's −∂² ln p/∂z² of it (n × n).
  Eigen::MatrixXd prior_curvature(const Eigen::VectorXd& z) const;

 private:
  /// The coordinate x of one parameter given the values of earlier ones, its slope, and the slope
  /// by its partner's value where that bounds it.
  struct Coordinate {
    double x, slope, by_partner;
  };
  Coordinate coordinate(std::size_t i, double z, const Eigen::VectorXd& values) const;
  /// Bounds of x given the values of earlier ones.
  std::array<double, 2> bounds(std::size_t i, const Eigen::VectorXd& values) const;
  double inverse(std::size_t i, double x, const Eigen::VectorXd& values) const;

  std::vector<FreeParameter> parameters_;
  std::vector<std::array<double, 2>> room_;  ///< bounds of x with what a partner leaves of them
  std::vector<std::optional<double>> held_;
};

/// z moved into the cube.
Eigen::VectorXd clipped(const Eigen::VectorXd& z);

}  // namespace repose::calibration
