#include "study/sensitivity/chaos.hpp"

#include <algorithm>
#include <stdexcept>

#include "calibration/dense.hpp"
#include "calibration/quantiles.hpp"

namespace repose::study {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Powers = std::vector<std::vector<int>>;

constexpr int highest_degree = 20;
constexpr Index most_terms = 500;

/// ψ_0 … ψ_degree at u, of unit variance:
///   Legendre: (k + 1) P_(k+1) = (2k + 1) x P_k − k P_(k−1), ψ_k = √(2k + 1) P_k
///   Hermite:  He_(k+1) = x He_k − k He_(k−1),               ψ_k = He_k/√k!
VectorXd orthonormal_values(Orthonormal family, double u, int degree) {
  VectorXd values(degree + 1);
  const bool legendre = family == Orthonormal::legendre;
  const double x = legendre ? 2.0 * u - 1.0 : calibration::normal_quantile(u);
  double before = 0.0, now = 1.0, factorial = 1.0;
  for (int k = 0; k <= degree; ++k) {
    values[k] = legendre ? std::sqrt(2.0 * k + 1.0) * now : now / std::sqrt(factorial);
    const double next =
        legendre ? ((2 * k + 1) * x * now - k * before) / (k + 1) : x * now - k * before;
    before = now;
    now = next;
    factorial *= k + 1;
  }
  return values;
}

/// All α with (Σ α_j^q)^(1/q) ≤ degree, by sum and then in the order of a book's index; empty if
/// they are more than `most`.
Powers truncated_powers(int inputs, int degree, double q, Index most) {
  Powers list;
  std::vector<int> alpha(static_cast<std::size_t>(inputs), 0);
  const double room = std::pow(degree, q) * (1.0 + 1e-12);
  for (bool more = true; more;) {
    if (static_cast<Index>(list.size()) == most) return {};
    list.push_back(alpha);
    more = false;
    for (std::size_t j = alpha.size(); j-- > 0 && !more;) {  // an odometer
      ++alpha[j];
      double sum = 0.0;
      for (const int a : alpha) sum += std::pow(a, q);
      more = sum <= room;
      if (!more) alpha[j] = 0;
    }
  }
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) {
    int of_a = 0, of_b = 0;
    for (const int x : a) of_a += x;
    for (const int x : b) of_b += x;
    return of_a < of_b;
  });
  return list;
}

double term_value(const std::vector<VectorXd>& at, const std::vector<int>& alpha) {
  double product = 1.0;
  for (std::size_t j = 0; j < alpha.size(); ++j)
    if (alpha[j] > 0) product *= at[j][alpha[j]];
  return product;
}

}  // namespace

PolynomialChaos::PolynomialChaos(const MatrixXd& u, std::span<const Orthonormal> families,
                                 const VectorXd& y)
    : families_(families.begin(), families.end()) {
  const Index n = u.rows(), inputs = u.cols();
  if (n < 2 * (inputs + 1))
    throw std::invalid_argument("PolynomialChaos: too few points for a polynomial");
  std::vector<std::vector<VectorXd>> at(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < inputs; ++j)
      at[static_cast<std::size_t>(i)].push_back(
          orthonormal_values(families_[static_cast<std::size_t>(j)], u(i, j), highest_degree));
  const VectorXd centred = y.array() - y.mean();
  const double variance = centred.squaredNorm() / static_cast<double>(n - 1);
  double least = HUGE_VAL;
  for (const double q : {1.0, 0.75, 0.5}) {
    std::size_t terms_before = 0;
    // all of them: an error may grow for some degrees before the one that the output needs
    for (int p = 1; p <= highest_degree; ++p) {
      Powers powers = truncated_powers(static_cast<int>(inputs), p, q, std::min(n / 2, most_terms));
      if (powers.empty()) break;
      if (powers.size() == terms_before) continue;
      terms_before = powers.size();
      const auto terms = static_cast<Index>(powers.size());
      MatrixXd values(n, terms);
      for (Index i = 0; i < n; ++i)
        for (Index k = 0; k < terms; ++k)
          values(i, k) =
              term_value(at[static_cast<std::size_t>(i)], powers[static_cast<std::size_t>(k)]);
      MatrixXd inverse = calibration::left_inverse(values);
      const VectorXd c = inverse * y;
      const VectorXd leverage =
          (values.array() * inverse.transpose().array()).rowwise().sum().matrix();
      const VectorXd left_out = (y - values * c).array() / (1.0 - leverage.array());
      const double few = static_cast<double>(n) / static_cast<double>(n - terms) *
                         (1.0 + inverse.squaredNorm());  // tr (ΨᵀΨ)⁻¹ = |(ΨᵀΨ)⁻¹Ψᵀ|²
      const double error = few * left_out.squaredNorm() / static_cast<double>(n);
      if (!(error < least)) continue;
      least = error;
      powers_ = std::move(powers);
      c_ = c;
      inverse_ = std::move(inverse);
      left_out_ = left_out;
      degree_ = p;
      norm_ = q;
    }
  }
  q2_ = 1.0 - least / variance;
}

Eigen::RowVectorXd PolynomialChaos::terms_at(const VectorXd& u) const {
  std::vector<VectorXd> at;
  for (std::size_t j = 0; j < families_.size(); ++j)
    at.push_back(orthonormal_values(families_[j], u[static_cast<Index>(j)], degree_));
  Eigen::RowVectorXd values(terms());
  for (Index k = 0; k < terms(); ++k)
    values[k] = term_value(at, powers_[static_cast<std::size_t>(k)]);
  return values;
}

double PolynomialChaos::operator()(const VectorXd& u) const { return terms_at(u) * c_; }

/// S_j = Σ c² of the terms with α_j alone / Σ c²; ST_j with those that have α_j at all.
VectorXd PolynomialChaos::shares_of(const VectorXd& c) const {
  const auto inputs = static_cast<Index>(families_.size());
  VectorXd shares = VectorXd::Zero(2 * inputs);
  double variance = 0.0;
  for (Index k = 1; k < c.size(); ++k) {
    const std::vector<int>& alpha = powers_[static_cast<std::size_t>(k)];
    const auto count = std::count_if(alpha.begin(), alpha.end(), [](int a) { return a > 0; });
    const double square = c[k] * c[k];
    variance += square;
    for (Index j = 0; j < inputs; ++j) {
      if (alpha[static_cast<std::size_t>(j)] == 0) continue;
      shares[inputs + j] += square;
      if (count == 1) shares[j] += square;
    }
  }
  return shares / variance;
}

std::vector<VarianceShares> PolynomialChaos::shares(std::uint64_t seed) const {
  const VectorXd errors = left_out_.array() - left_out_.mean();
  const std::vector<Bounded> figures =
      with_intervals(shares_of(c_), seed, [&](std::mt19937_64& random) {
        const std::vector<Index> drawn = drawn_again(errors.size(), random);
        return shares_of(c_ + inverse_ * errors(drawn));
      });
  const auto share = [](Bounded figure) {  // a sum of squares is not negative
    for (double& end : figure.interval_95) end = std::max(end, 0.0);
    return figure;
  };
  std::vector<VarianceShares> list;
  for (std::size_t j = 0; j < families_.size(); ++j)
    list.push_back({share(figures[j]), share(figures[families_.size() + j])});
  return list;
}

}  // namespace repose::study
