#pragma once
/// \file
/// What a fit may change: named values with bounds and scale, and the coordinates z in [0, 1]^n in
/// which every optimiser works.
///
///   linear   x = lower + z (upper − lower)
///   log      x = lower (upper/lower)^z
/// A parameter may be given as a ratio to another, value = x · value(other): κ = x λ with x in
/// (0, 1) keeps κ < λ for every z.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "models/parameter.hpp"

namespace repose::calibration {

/// A penalty that keeps a value near what is known from elsewhere: the residual
/// (value − mean)/sd, or ln(value/mean)/sd where the parameter's scale is log (sd is then
/// relative).
struct Prior {
  double mean = 0.0;
  double sd = 1.0;
};

struct FreeParameter {
  std::string name;  ///< "M", "ocr of A7"
  std::string unit = "-";
  double lower = 0.0;  ///< of the coordinate x
  double upper = 1.0;
  Scale scale = Scale::linear;
  int of = -1;                  ///< x is a ratio to this earlier parameter; −1: x is the value
  std::optional<double> start;  ///< of the coordinate x; default: the middle of its scale
  std::optional<Prior> prior;   ///< on the value
};

class ParameterSpace {
 public:
  ParameterSpace() = default;
  /// Errors: InputError (key = the parameter's name) for bounds that are not finite or not in
  /// order, log bounds that are not positive, a ratio to a later parameter, a prior without sd > 0.
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
  /// z of the starting values, clipped into the cube: a start outside its bounds begins on them.
  Eigen::VectorXd start() const;
  /// The k-th point of a low-discrepancy sequence (Halton 1960 with a random shift by `seed`,
  /// Cranley & Patterson 1976); the same (k, seed) gives the same point.
  Eigen::VectorXd spread_point(std::size_t k, std::uint64_t seed) const;

  std::size_t prior_count() const;
  /// Residuals of the priors and, if J is given (prior_count × n), their derivatives to z.
  void priors(const Eigen::VectorXd& z, Eigen::Ref<Eigen::VectorXd> r,
              Eigen::Ref<Eigen::MatrixXd>* J) const;

 private:
  std::vector<FreeParameter> parameters_;
};

/// z moved into the cube.
Eigen::VectorXd clipped(const Eigen::VectorXd& z);

}  // namespace repose::calibration
