#include "calibration/curve_error.hpp"

#include <cmath>

#include "calibration/noise.hpp"
#include "models/dual.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

template <class T>
T neighbours(const T& length, Index rows) {
  using std::exp;
  return rows > 1 ? exp(-1.0 / (length * static_cast<double>(rows - 1))) : T(0.0);
}

/// Prediction of one row from those before it.
template <class T>
struct Step {
  T variance;  ///< of the innovation, F
  T gain;      ///< k: share of the innovation that is taken for δ
};

/// The variances of the filter, which do not depend on the data: P of δ_i given the rows before,
/// F = P + σ²w², k = P/F, then P ← ρ² (1 − k) P + (1 − ρ²) τ² (Kalman 1960).
template <class T, class Each>
void filter(const T& noise, const T& discrepancy, const T& rho, const VectorXd& w, Each&& each) {
  const T all = discrepancy * discrepancy, white = noise * noise;
  T variance = all;
  for (Index i = 0; i < w.size(); ++i) {
    const T total = variance + white * (w[i] * w[i]);
    const T gain = variance / total;
    each(i, Step<T>{total, gain});
    variance = rho * rho * (1.0 - gain) * variance + (1.0 - rho * rho) * all;
  }
}

}  // namespace

CurveLikelihood likelihood(const CurveError& error, const VectorXd& e, const VectorXd& w) {
  using Dual = ceres::Jet<double, 3>;  // by the logarithms
  using std::log;
  const auto by_logarithm = [](double value, int k) {
    Dual x(value);
    x.v[k] = value;
    return x;
  };
  const Index n = e.size();
  const Dual rho = neighbours(by_logarithm(error.length, 2), n);
  Dual mean(0.0), sum(0.0);  // of δ_i given the rows before; of −2 ln p
  VectorXd innovation(n), variance(n), gain(n);
  filter(by_logarithm(error.noise, 0), by_logarithm(error.discrepancy, 1), rho, w,
         [&](Index i, const Step<Dual>& step) {
           const Dual v = e[i] - mean;
           sum += v * v / step.variance + log(step.variance);
           mean = rho * (mean + step.gain * v);
           innovation[i] = v.a;
           variance[i] = step.variance.a;
           gain[i] = step.gain.a;
         });
  CurveLikelihood result;
  result.value = -0.5 * sum.a;
  for (int k = 0; k < 3; ++k) result.by_logarithm[static_cast<std::size_t>(k)] = -0.5 * sum.v[k];
  // C⁻¹e by the filter run backwards (the disturbance smoother of Koopman, Biometrika 80 (1993)
  // 117)
  result.by_row.resize(n);
  double later = 0.0;
  for (Index i = n - 1; i >= 0; --i) {
    const double own = innovation[i] / variance[i];
    result.by_row[i] = -(own - rho.a * gain[i] * later);
    later = own + rho.a * (1.0 - gain[i]) * later;
  }
  return result;
}

MatrixXd innovations(const CurveError& error, const MatrixXd& columns, const VectorXd& w) {
  const double rho = neighbours(error.length, columns.rows());
  Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(columns.cols());
  MatrixXd white(columns.rows(), columns.cols());
  filter(error.noise, error.discrepancy, rho, w, [&](Index i, const Step<double>& step) {
    const Eigen::RowVectorXd v = columns.row(i) - mean;
    white.row(i) = v / std::sqrt(step.variance);
    mean = rho * (mean + step.gain * v);
  });
  return white;
}

VectorXd drawn_error(const CurveError& error, const VectorXd& w, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  VectorXd noise(w.size()), white(w.size());
  for (double& x : noise) x = normal(random);
  for (double& x : white) x = normal(random);
  return error.noise * w.cwiseProduct(noise) +
         error.discrepancy * coloured(white, neighbours(error.length, w.size()));
}

}  // namespace repose::calibration
