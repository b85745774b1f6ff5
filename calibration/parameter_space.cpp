#include "calibration/parameter_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

Index at(std::size_t i) { return static_cast<Index>(i); }

/// i in base b with its digits mirrored at the point: 6 = 110 (base 2) → 0.011 = 0.375
double radical_inverse(std::size_t i, std::size_t base) {
  double inverse = 0.0, digit = 1.0 / static_cast<double>(base);
  for (; i > 0; i /= base, digit /= static_cast<double>(base))
    inverse += digit * static_cast<double>(i % base);
  return inverse;
}

}  // namespace

ParameterSpace::ParameterSpace(std::vector<FreeParameter> parameters)
    : parameters_(std::move(parameters)),
      held_(parameters_.size()) {
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const FreeParameter& p = parameters_[i];
    if (!std::isfinite(p.lower) || !std::isfinite(p.upper) || !(p.lower < p.upper))
      throw InputError(p.name, p.name + " needs finite bounds with lower < upper");
    if (p.scale == Scale::log && !(p.lower > 0.0))
      throw InputError(p.name, p.name + ": a logarithmic scale needs lower > 0");
    if (p.start && !(*p.start >= p.lower && *p.start <= p.upper))
      throw InputError(p.name, p.name + ": start must lie within lower and upper");
    if (p.of >= static_cast<int>(i) || p.below >= static_cast<int>(i))
      throw InputError(p.name, p.name + " is a ratio to a parameter that must come before it");
    if (p.prior && !(p.prior->sd > 0.0 && std::isfinite(p.prior->mean)))
      throw InputError(p.name, p.name + ": a prior needs a finite mean and sd > 0");
    if (p.prior && p.prior->relative && !(p.prior->mean > 0.0))
      throw InputError(p.name, p.name + ": a prior with a relative sd needs mean > 0");
    room_.push_back({p.lower, p.upper});
    if (p.below < 0) continue;
    // what lies above has to leave room for the lowest value of what lies below
    auto& above = room_[static_cast<std::size_t>(p.below)];
    const FreeParameter& partner = parameters_[static_cast<std::size_t>(p.below)];
    above[0] = std::max(above[0], p.lower / below_share);
    if (!(above[0] < above[1]))
      throw InputError(p.name, p.name + " must be less than " + partner.name + ", but its lower " +
                                   "bound leaves none of the bounds of " + partner.name);
  }
}

std::array<double, 2> ParameterSpace::bounds(std::size_t i, const VectorXd& values) const {
  const FreeParameter& p = parameters_[i];
  std::array<double, 2> b = room_[i];
  if (p.below >= 0) b[1] = std::max(b[0], std::min(b[1], below_share * values[p.below]));
  return b;
}

ParameterSpace::Coordinate ParameterSpace::coordinate(std::size_t i, double z,
                                                      const VectorXd& values) const {
  const FreeParameter& p = parameters_[i];
  const auto [low, high] = bounds(i, values);
  const bool capped = p.below >= 0 && high < room_[i][1] && high > low;
  if (p.scale == Scale::log) {
    const double ratio = std::log(high / low);
    const double x = low * std::exp(z * ratio);
    return {x, x * ratio, capped ? below_share * z * x / high : 0.0};
  }
  return {low + z * (high - low), high - low, capped ? below_share * z : 0.0};
}

double ParameterSpace::inverse(std::size_t i, double x, const VectorXd& values) const {
  const auto [low, high] = bounds(i, values);
  if (!(high > low)) return 0.0;
  return parameters_[i].scale == Scale::log ? std::log(x / low) / std::log(high / low)
                                            : (x - low) / (high - low);
}

VectorXd ParameterSpace::values(const VectorXd& z) const {
  VectorXd v(at(size()));
  for (std::size_t i = 0; i < size(); ++i) {
    const FreeParameter& p = parameters_[i];
    v[at(i)] = held_[i] ? *held_[i] : coordinate(i, z[at(i)], v).x * (p.of < 0 ? 1.0 : v[p.of]);
  }
  return v;
}

Eigen::MatrixXd ParameterSpace::slopes(const VectorXd& z) const {
  const VectorXd v = values(z);
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(at(size()), at(size()));
  for (std::size_t i = 0; i < size(); ++i) {
    if (held_[i]) continue;
    const FreeParameter& p = parameters_[i];
    const Coordinate c = coordinate(i, z[at(i)], v);
    if (p.of >= 0) d.row(at(i)) = c.x * d.row(p.of);
    if (p.below >= 0) d.row(at(i)) = c.by_partner * d.row(p.below);
    d(at(i), at(i)) = c.slope * (p.of < 0 ? 1.0 : v[p.of]);
  }
  return d;
}

VectorXd ParameterSpace::coordinates(const VectorXd& values) const {
  VectorXd z(at(size()));
  for (std::size_t i = 0; i < size(); ++i) {
    const FreeParameter& p = parameters_[i];
    z[at(i)] = held_[i] ? 0.5 : inverse(i, values[at(i)] / (p.of < 0 ? 1.0 : values[p.of]), values);
  }
  return z;
}

VectorXd ParameterSpace::start() const {
  VectorXd z = VectorXd::Constant(at(size()), 0.5), v(at(size()));
  for (std::size_t i = 0; i < size(); ++i) {
    const FreeParameter& p = parameters_[i];
    if (p.start && !held_[i]) z[at(i)] = std::min(1.0, std::max(0.0, inverse(i, *p.start, v)));
    v[at(i)] = held_[i] ? *held_[i] : coordinate(i, z[at(i)], v).x * (p.of < 0 ? 1.0 : v[p.of]);
  }
  return z;
}

std::array<double, 2> ParameterSpace::reach(std::size_t i) const {
  const FreeParameter& p = parameters_[i];
  if (p.of >= 0) {
    // a ratio may be negative only where a user gives it such bounds
    const auto& other = room_[static_cast<std::size_t>(p.of)];
    const std::array<double, 4> corner{room_[i][0] * other[0], room_[i][0] * other[1],
                                       room_[i][1] * other[0], room_[i][1] * other[1]};
    return {*std::min_element(corner.begin(), corner.end()),
            *std::max_element(corner.begin(), corner.end())};
  }
  std::array<double, 2> b = room_[i];
  if (p.below >= 0)
    b[1] = std::min(b[1], below_share * room_[static_cast<std::size_t>(p.below)][1]);
  return b;
}

std::optional<ParameterSpace> ParameterSpace::held(std::size_t i, double value) const {
  ParameterSpace space = *this;
  const FreeParameter& p = parameters_[i];
  space.held_[i] = value;
  if (p.of >= 0) {
    auto& other = space.room_[static_cast<std::size_t>(p.of)];
    if (!(value > 0.0) || !(other[0] >= 0.0)) return {};
    if (room_[i][0] > 0.0) other[1] = std::min(other[1], value / room_[i][0]);
    other[0] = std::max(other[0], value / room_[i][1]);
    if (!(other[0] < other[1])) return {};
    return space;
  }
  if (!(value >= room_[i][0] && value <= room_[i][1])) return {};
  if (p.below >= 0) {
    auto& other = space.room_[static_cast<std::size_t>(p.below)];
    other[0] = std::max(other[0], value / below_share);
    if (!(other[0] < other[1])) return {};
  }
  return space;
}

ParameterSpace ParameterSpace::with_prior_means(const VectorXd& means) const {
  ParameterSpace space = *this;
  Index row = 0;
  for (FreeParameter& p : space.parameters_)
    if (p.prior) p.prior->mean = means[row++];
  return space;
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
    const bool relative = p.prior->relative;
    r[row] =
        (relative ? std::log(v[at(i)] / p.prior->mean) : v[at(i)] - p.prior->mean) / p.prior->sd;
    if (J != nullptr) J->row(row) = slope.row(at(i)) / (p.prior->sd * (relative ? v[at(i)] : 1.0));
    ++row;
  }
}

double ParameterSpace::log_prior(const VectorXd& z, VectorXd& gradient) const {
  gradient = VectorXd::Zero(at(size()));
  const auto n = at(prior_count());
  if (n == 0) return 0.0;
  const VectorXd v = values(z);
  const Eigen::MatrixXd d = slopes(z);
  VectorXd r(n);
  Eigen::MatrixXd J(n, at(size()));
  Eigen::Ref<Eigen::MatrixXd> by_z = J;
  priors(z, r, &by_z);
  gradient = -J.transpose() * r;
  double sum = -0.5 * r.squaredNorm();
  for (std::size_t i = 0; i < size(); ++i) {
    const FreeParameter& p = parameters_[i];
    if (!p.prior) continue;
    // ln |∂value/∂z| and where it comes from: the scale, the partner's bound, the ratio
    const auto [low, high] = bounds(i, v);
    const Coordinate c = coordinate(i, z[at(i)], v);
    sum += std::log(c.slope);
    const bool log = p.scale == Scale::log;
    const double ratio = log ? std::log(high / low) : 0.0;
    gradient[at(i)] += ratio;
    if (p.below >= 0 && high < room_[i][1]) {
      const double by_high = log ? (z[at(i)] + 1.0 / ratio) / high : 1.0 / (high - low);
      gradient += by_high * below_share * d.row(p.below).transpose();
    }
    if (p.of >= 0) {
      sum += std::log(std::abs(v[p.of]));
      gradient += d.row(p.of).transpose() / v[p.of];
    }
    if (p.prior->relative) {  // ∂ ln value/∂z
      sum -= std::log(std::abs(v[at(i)]));
      gradient -= d.row(at(i)).transpose() / v[at(i)];
    }
  }
  return sum;
}

Eigen::MatrixXd ParameterSpace::prior_curvature(const VectorXd& z) const {
  const auto n = at(prior_count());
  VectorXd r(n);
  Eigen::MatrixXd J(n, at(size()));
  Eigen::Ref<Eigen::MatrixXd> by_z = J;
  if (n > 0) priors(z, r, &by_z);
  return J.transpose() * J;
}

VectorXd clipped(const VectorXd& z) { return z.cwiseMax(0.0).cwiseMin(1.0); }

}  // namespace repose::calibration
