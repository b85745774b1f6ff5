#include "calibration/parameter_space.hpp"

#include <array>
#include <cmath>
#include <random>

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

Index at(std::size_t i) { return static_cast<Index>(i); }

/// The coordinate x of one parameter, and dx/dz.
struct Coordinate {
  double x, slope;
};
Coordinate coordinate(const FreeParameter& p, double z) {
  if (p.scale == Scale::log) {
    const double ratio = std::log(p.upper / p.lower);
    const double x = p.lower * std::exp(z * ratio);
    return {x, x * ratio};
  }
  return {p.lower + z * (p.upper - p.lower), p.upper - p.lower};
}

/// i in base b with its digits mirrored at the point: 6 = 110 (base 2) → 0.011 = 0.375
double radical_inverse(std::size_t i, std::size_t base) {
  double inverse = 0.0, digit = 1.0 / static_cast<double>(base);
  for (; i > 0; i /= base, digit /= static_cast<double>(base))
    inverse += digit * static_cast<double>(i % base);
  return inverse;
}

}  // namespace

ParameterSpace::ParameterSpace(std::vector<FreeParameter> parameters)
    : parameters_(std::move(parameters)) {
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const FreeParameter& p = parameters_[i];
    if (!std::isfinite(p.lower) || !std::isfinite(p.upper) || !(p.lower < p.upper))
      throw InputError(p.name, p.name + " needs finite bounds with lower < upper");
    if (p.scale == Scale::log && !(p.lower > 0.0))
      throw InputError(p.name, p.name + ": a logarithmic scale needs lower > 0");
    if (p.of >= static_cast<int>(i))
      throw InputError(p.name, p.name + " is a ratio to a parameter that must come before it");
    if (p.prior && !(p.prior->sd > 0.0 && std::isfinite(p.prior->mean)))
      throw InputError(p.name, p.name + ": a prior needs a finite mean and sd > 0");
    if (p.prior && p.scale == Scale::log && !(p.prior->mean > 0.0))
      throw InputError(p.name, p.name + ": a prior on a logarithmic scale needs mean > 0");
  }
}

VectorXd ParameterSpace::values(const VectorXd& z) const {
  VectorXd v(at(size()));
  for (std::size_t i = 0; i < size(); ++i) {
    const FreeParameter& p = parameters_[i];
    v[at(i)] = coordinate(p, z[at(i)]).x * (p.of < 0 ? 1.0 : v[p.of]);
  }
  return v;
}

Eigen::MatrixXd ParameterSpace::slopes(const VectorXd& z) const {
  const VectorXd v = values(z);
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(at(size()), at(size()));
  for (std::size_t i = 0; i < size(); ++i) {
    const FreeParameter& p = parameters_[i];
    const Coordinate c = coordinate(p, z[at(i)]);
    if (p.of >= 0) d.row(at(i)) = c.x * d.row(p.of);
    d(at(i), at(i)) = c.slope * (p.of < 0 ? 1.0 : v[p.of]);
  }
  return d;
}

VectorXd ParameterSpace::coordinates(const VectorXd& values) const {
  VectorXd z(at(size()));
  for (std::size_t i = 0; i < size(); ++i) {
    const FreeParameter& p = parameters_[i];
    const double x = values[at(i)] / (p.of < 0 ? 1.0 : values[p.of]);
    z[at(i)] = p.scale == Scale::log ? std::log(x / p.lower) / std::log(p.upper / p.lower)
                                     : (x - p.lower) / (p.upper - p.lower);
  }
  return z;
}

VectorXd ParameterSpace::start() const {
  VectorXd z = VectorXd::Constant(at(size()), 0.5);
  for (std::size_t i = 0; i < size(); ++i) {
    const FreeParameter& p = parameters_[i];
    if (!p.start) continue;
    if (p.scale == Scale::log)  // what is not positive lies below the lower bound
      z[at(i)] = *p.start > 0.0 ? std::log(*p.start / p.lower) / std::log(p.upper / p.lower) : 0.0;
    else
      z[at(i)] = (*p.start - p.lower) / (p.upper - p.lower);
  }
  return clipped(z);
}

VectorXd ParameterSpace::spread_point(std::size_t k, std::uint64_t seed) const {
  constexpr std::array<std::size_t, 20> primes{2,  3,  5,  7,  11, 13, 17, 19, 23, 29,
                                               31, 37, 41, 43, 47, 53, 59, 61, 67, 71};
  std::mt19937_64 random(seed ^ 0x9e3779b97f4a7c15ULL);
  VectorXd z(at(size()));
  for (std::size_t i = 0; i < size(); ++i) {
    const double shift = static_cast<double>(random() >> 11) * 0x1p-53;
    const double x = radical_inverse(k + 1, primes[i % primes.size()]) + shift;
    z[at(i)] = x - std::floor(x);
  }
  return z;
}

std::size_t ParameterSpace::prior_count() const {
  std::size_t n = 0;
  for (const FreeParameter& p : parameters_) n += p.prior ? 1 : 0;
  return n;
}

void ParameterSpace::priors(const VectorXd& z, Eigen::Ref<VectorXd> r,
                            Eigen::Ref<Eigen::MatrixXd>* J) const {
  const VectorXd v = values(z);
  Eigen::MatrixXd slope;
  if (J != nullptr) slope = slopes(z);
  Index row = 0;
  for (std::size_t i = 0; i < size(); ++i) {
    const FreeParameter& p = parameters_[i];
    if (!p.prior) continue;
    const bool log = p.scale == Scale::log;
    r[row] = (log ? std::log(v[at(i)] / p.prior->mean) : v[at(i)] - p.prior->mean) / p.prior->sd;
    if (J != nullptr) J->row(row) = slope.row(at(i)) / (p.prior->sd * (log ? v[at(i)] : 1.0));
    ++row;
  }
}

VectorXd clipped(const VectorXd& z) { return z.cwiseMax(0.0).cwiseMin(1.0); }

}  // namespace repose::calibration
