#pragma once
/// \file
/// Decompositions of small dense matrices, each of Eigen's compiled once (seconds apiece).

#include <Eigen/Core>

namespace repose::calibration {

/// A = U diag(s) Vᵀ with k = min(rows, columns) columns in U and V, s ≥ 0 from large to small:
/// Jacobi rotations on R of A's QR decomposition with column pivoting, which keeps small singular
/// values to their own relative precision (Higham, Accuracy and Stability, 2002, §19).
struct SingularValues {
  Eigen::MatrixXd U, V;
  Eigen::VectorXd s;
};
SingularValues singular_values(const Eigen::MatrixXd& A);

/// The x of min ‖A x − b‖, by QR with column pivoting.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// (AᵀA)⁻¹Aᵀ = R⁻¹Qᵀ of a matrix whose columns are independent, by QR without pivoting: its rows
/// give the x of min ‖A x − b‖ for any b.
Eigen::MatrixXd left_inverse(const Eigen::MatrixXd& A);

/// Of a square matrix that has one.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& A);

}  // namespace repose::calibration
