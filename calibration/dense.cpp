#include "calibration/dense.hpp"

#include <utility>

#include <Eigen/QR>
#include <Eigen/SVD>

namespace repose::calibration {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

SingularValues singular_values(const MatrixXd& A) {
  if (A.rows() < A.cols()) {
    SingularValues turned = singular_values(A.transpose());
    std::swap(turned.U, turned.V);
    return turned;
  }
  const Index k = A.cols();
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
  const MatrixXd R = qr.matrixR().topRows(k).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<MatrixXd, Eigen::NoQRPreconditioner> svd(
      R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  SingularValues result;
  result.s = svd.singularValues();
  result.U = MatrixXd::Zero(A.rows(), k);
  result.U.topRows(k) = svd.matrixU();
  result.U.applyOnTheLeft(qr.householderQ());
  result.V = qr.colsPermutation() * svd.matrixV();
  return result;
}

VectorXd least_squares(const MatrixXd& A, const VectorXd& b) {
  return A.colPivHouseholderQr().solve(b);
}

MatrixXd left_inverse(const MatrixXd& A) {
  const Eigen::HouseholderQR<MatrixXd> qr(A);
  const MatrixXd Q = qr.householderQ() * MatrixXd::Identity(A.rows(), A.cols());
  return qr.matrixQR().topRows(A.cols()).triangularView<Eigen::Upper>().solve(Q.transpose());
}

MatrixXd inverse(const MatrixXd& A) { return A.colPivHouseholderQr().inverse(); }

}  // namespace repose::calibration
