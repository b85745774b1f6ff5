#pragma once
/// \file
/// Points that fill the unit cube evenly: a digital (t, s)-sequence in base 2 after Sobol' (1967),
/// scrambled by Owen (1995).

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace repose::study {

/// The direction numbers start from values that are searched for rather than tabled: dimension by
/// dimension, of a few candidates those with the most even projections onto the planes with every
/// dimension before. Every 2^m points from the first have one point in each interval of length 2^-m
/// along each axis.
class LowDiscrepancy {
 public:
  static constexpr std::size_t most_dimensions = 40;

  /// Errors: std::invalid_argument for more than most_dimensions. Other seeds scramble otherwise.
  LowDiscrepancy(std::size_t dimensions, std::uint64_t seed);

  /// The k-th point, each coordinate inside (0, 1).
  Eigen::VectorXd point(std::uint32_t k) const;

  /// Of the first 2^m points in the plane of two dimensions: m − t, the largest ρ for which every
  /// box of the sizes 2^-a × 2^-(ρ − a) holds its share of them (Niederreiter 1987).
  int strength(std::size_t i, std::size_t j, int m) const;

 private:
  /// V_k = m_k 2^(32 − k), k = 1 … 32.
  using Directions = std::vector<std::uint32_t>;

  static int strength(const Directions& a, const Directions& b, int m);

  std::vector<Directions> directions_;
  std::uint64_t seed_;
};

/// A well-mixed value of any (splitmix64; Steele, Lea & Flood 2014).
std::uint64_t mixed(std::uint64_t x);

}  // namespace repose::study
