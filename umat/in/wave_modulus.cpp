#include "umat/in/wave_modulus.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace repose::umat {

template <int N>
double wave_modulus(const double* ddsdde) {
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  // in Mandel's notation, where a shear component counts √2 times, a contraction is a product; of
  // DDSDDE, which multiplies γ = √2 (√2 ε), a shear row or column is then √2 times as large
  Vector weight = Vector::Constant(std::sqrt(2.0));
  weight.template head<3>().setOnes();
  const Matrix raw = Eigen::Map<const Matrix>(ddsdde);
  Matrix D = 0.5 * (raw + raw.transpose());
  D = weight.asDiagonal() * D * weight.asDiagonal();
  Vector I = Vector::Zero();
  I.template head<3>().setOnes();
  const Matrix dev = Matrix::Identity() - I * I.transpose() / 3.0;
  const Vector volumetric = D * I;
  const double K = I.dot(volumetric) / 9.0;
  const Matrix of_shear = dev * D * dev;
  Eigen::SelfAdjointEigenSolver<Matrix> solver(of_shear, Eigen::EigenvaluesOnly);
  const double shear = std::max(0.0, solver.eigenvalues().maxCoeff());
  const double coupling = (dev * volumetric).norm();
  return std::max(
      {0.0, K + 2.0 / 3.0 * std::sqrt(2.0 / 3.0) * coupling + 2.0 / 3.0 * shear, 0.5 * shear});
}

template double wave_modulus<4>(const double*);
template double wave_modulus<6>(const double*);

}  // namespace repose::umat
