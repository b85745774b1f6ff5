// calibration/dense.hpp: the decompositions have the properties that define them.

#include "calibration/dense.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Entries 1/(i + j + 1): of a condition number that grows 30 times with each column.
MatrixXd hilbert(Index rows, Index columns) {
  MatrixXd A(rows, columns);
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < columns; ++j) A(i, j) = 1.0 / static_cast<double>(i + j + 1);
  return A;
}

/// Round-off of a product of orthogonal factors: Higham 2002, (19.3), c m n ε with c of order one.
double round_off(const MatrixXd& A) {
  return 4.0 * static_cast<double>(A.rows() * A.cols()) * 0x1p-53;
}

void expect_decomposition(const MatrixXd& A) {
  const SingularValues d = singular_values(A);
  const Index k = std::min(A.rows(), A.cols());
  ASSERT_EQ(d.U.rows(), A.rows());
  ASSERT_EQ(d.V.rows(), A.cols());
  ASSERT_EQ(d.U.cols(), k);
  ASSERT_EQ(d.V.cols(), k);
  const double eps = round_off(A);
  const MatrixXd unit = MatrixXd::Identity(k, k);
  EXPECT_LT((d.U.transpose() * d.U - unit).norm(), eps);
  EXPECT_LT((d.V.transpose() * d.V - unit).norm(), eps);
  EXPECT_LE((d.U * d.s.asDiagonal() * d.V.transpose() - A).norm(), eps * A.norm());
  for (Index i = 0; i < k; ++i) {
    EXPECT_GE(d.s[i], 0.0);
    EXPECT_LE(d.s[i], d.s[std::max<Index>(i, 1) - 1]);
  }
}

TEST(Dense, SingularValuesOfTallSquareAndWide) {
  expect_decomposition(hilbert(40, 6));
  expect_decomposition(hilbert(5, 5));
  expect_decomposition(hilbert(3, 7));
  expect_decomposition(hilbert(4, 1));
}

TEST(Dense, SingularValuesWhereColumnsDependOnEachOther) {
  MatrixXd A = hilbert(12, 4);
  A.col(3) = 2.0 * A.col(0) - A.col(1);
  expect_decomposition(A);
  EXPECT_LT(singular_values(A).s[3], round_off(A) * A.norm());
  expect_decomposition(MatrixXd::Zero(6, 3));
}

TEST(Dense, SmallSingularValuesKeepTheirDigits) {
  // columns of very different size, neighbours at an angle: AᵀA = D T D, D = diag(1, 1e-6, 1e-12),
  // T tridiagonal with 1 and a = c s, so that Π s² = det D² (1 − 2a²)
  MatrixXd A = MatrixXd::Zero(4, 3);
  const double c = std::cos(0.3), s = std::sin(0.3);
  const double size[] = {1.0, 1e-6, 1e-12};
  for (Index j = 0; j < 3; ++j) {
    A(j, j) = c * size[j];
    A(j + 1, j) += s * size[j];
  }
  const double exact = 1e-36 * (1.0 - 2.0 * c * c * s * s);
  // of each of the six factors round_off(A) times the condition of T, (1 + √2 a)/(1 − √2 a) = 2.3
  EXPECT_NEAR(singular_values(A).s.array().square().prod() / exact, 1.0, 14.0 * round_off(A));
}

TEST(Dense, LeastSquaresLeavesAResidualAcrossTheColumns) {
  const MatrixXd A = hilbert(20, 4);
  const VectorXd b = VectorXd::LinSpaced(20, -1.0, 1.0).array().sin();
  const VectorXd x = least_squares(A, b);
  // x solves a problem that differs from this one by round_off(A) of A and of b
  EXPECT_LT((A.transpose() * (A * x - b)).norm(),
            round_off(A) * A.norm() * (A.norm() * x.norm() + b.norm()));
}

TEST(Dense, InverseTimesItselfIsOne) {
  MatrixXd A = MatrixXd::Identity(4, 4);
  A(2, 0) = -3.0;
  A(1, 3) = 0.25;
  EXPECT_LT((inverse(A) * A - MatrixXd::Identity(4, 4)).norm(), 10.0 * round_off(A));
}

}  // namespace
}  // namespace repose::calibration
