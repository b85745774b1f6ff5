#include "calibration/design.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double log_determinant(const Eigen::LLT<MatrixXd>& root) {
  const MatrixXd lower = root.matrixL();
  return 2.0 * lower.diagonal().array().log().sum();
}

/// Standard deviations of the values, of information M and slopes S (values × coordinates).
VectorXd widths(const Eigen::LLT<MatrixXd>& root, const MatrixXd& S) {
  const MatrixXd half = root.matrixL().solve(S.transpose());
  return half.colwise().norm().transpose();
}

}  // namespace

Design design(const Problem& problem, const Uncertainty& at, const VectorXd& z,
              const std::vector<Target>& candidates, int tests) {
  std::vector<Index> inside;
  for (std::size_t i = 0; i < at.at_bound.size(); ++i)
    if (at.at_bound[i] == 0) inside.push_back(static_cast<Index>(i));
  Design design;
  if (inside.empty() || candidates.empty()) return design;
  const MatrixXd slopes = problem.space().slopes(z);
  const MatrixXd S = slopes(Eigen::all, inside);

  std::vector<MatrixXd> told;  // JᵀJ of each
  std::vector<bool> failed;
  for (const Target& candidate : candidates) {
    const Problem alone(problem.space(), {candidate}, false);
    Evaluation e;
    alone.evaluate(z, true, e);
    problem.account(alone);
    const MatrixXd J = e.J.topRows(candidate.count())(Eigen::all, inside);
    told.push_back(J.transpose() * J);
    failed.push_back(e.failed);
  }
  const auto taught = [&](const MatrixXd& before, std::size_t k) {
    Taught t;
    t.candidate = k;
    t.failed = failed[k];
    t.narrower = VectorXd::Ones(S.rows());
    if (t.failed) return t;
    const Eigen::LLT<MatrixXd> first(before), then(before + told[k]);
    t.gain = 0.5 * (log_determinant(then) - log_determinant(first));
    const VectorXd from = widths(first, S), to = widths(then, S);
    for (Index i = 0; i < S.rows(); ++i)
      if (from[i] > 0.0) t.narrower[i] = to[i] / from[i];
    Index most = 0;
    t.narrower.minCoeff(&most);
    t.most = static_cast<std::size_t>(most);
    return t;
  };
  MatrixXd known = at.information(inside, inside);
  for (int n = 0; n < tests; ++n) {
    std::vector<Taught> all;
    for (std::size_t k = 0; k < candidates.size(); ++k) all.push_back(taught(known, k));
    std::stable_sort(all.begin(), all.end(),
                     [](const Taught& a, const Taught& b) { return a.gain > b.gain; });
    if (all.front().failed || !(all.front().gain > 0.0)) {
      if (n == 0) design.candidates = std::move(all);
      break;
    }
    design.sequence.push_back(all.front());
    known += told[all.front().candidate];
    if (n == 0) design.candidates = std::move(all);
  }
  return design;
}

}  // namespace repose::calibration
