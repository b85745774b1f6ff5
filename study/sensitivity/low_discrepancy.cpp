#include "study/sensitivity/low_discrepancy.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace repose::study {
namespace {

constexpr int bits = 32;

/// A polynomial over GF(2) as bits, the coefficient of x^k in bit k.
struct BinaryPolynomial {
  int degree = 0;
  std::uint32_t coefficients = 1;
};

/// Whether x runs through all 2^degree − 1 residues before it comes back to 1.
bool is_primitive(const BinaryPolynomial& p) {
  const std::uint32_t top = 1u << p.degree;
  std::uint32_t x = 1;
  for (std::uint32_t k = 1; k < top; ++k) {
    x <<= 1;
    if ((x & top) != 0) x ^= p.coefficients;
    if (x == 1) return k == top - 1;
  }
  return false;
}

/// The first so many primitive polynomials, by degree.
std::vector<BinaryPolynomial> primitive_polynomials(std::size_t count) {
  std::vector<BinaryPolynomial> list;
  for (int degree = 1; list.size() < count; ++degree)
    for (std::uint32_t inner = 0; inner < 1u << (degree - 1) && list.size() < count; ++inner) {
      const BinaryPolynomial p{degree, (1u << degree) | (inner << 1) | 1u};
      if (is_primitive(p)) list.push_back(p);
    }
  return list;
}

/// m_k = 2 a_1 m_(k−1) ⊕ … ⊕ 2^s m_(k−s) ⊕ m_(k−s)  (Sobol' 1967; Bratley & Fox 1988), from m_k,
/// k ≤ s, odd and below 2^k.
std::vector<std::uint32_t> directions_from(const BinaryPolynomial& p, std::uint64_t candidate) {
  std::vector<std::uint32_t> m;
  for (int k = 0; k < bits; ++k) {
    std::uint32_t next = 0;
    if (k < p.degree) {
      const std::uint64_t drawn = mixed(mixed(candidate) + static_cast<std::uint64_t>(k));
      next = (static_cast<std::uint32_t>(drawn >> 32) & ((1u << k) - 1u)) << 1 | 1u;
    } else {
      next = m[static_cast<std::size_t>(k - p.degree)];
      for (int i = 1; i <= p.degree; ++i)
        if ((p.coefficients >> (p.degree - i) & 1u) != 0)
          next ^= m[static_cast<std::size_t>(k - i)] << i;
    }
    m.push_back(next);
  }
  for (int k = 0; k < bits; ++k) m[static_cast<std::size_t>(k)] <<= bits - 1 - k;
  return m;
}

/// Row r of the generator matrix that makes digit r (from the point on) of a coordinate.
std::uint32_t generator_row(const std::vector<std::uint32_t>& directions, int r, int m) {
  std::uint32_t row = 0;
  for (int k = 0; k < m; ++k)
    row |= (directions[static_cast<std::size_t>(k)] >> (bits - 1 - r) & 1u) << k;
  return row;
}

/// Vectors over GF(2) that are known to be independent, reduced by their leading bits.
class BinarySpan {
 public:
  /// False if it lies in the span.
  bool add(std::uint32_t row) {
    for (int k = bits - 1; k >= 0 && row != 0; --k) {
      if ((row >> k & 1u) == 0) continue;
      std::uint32_t& leader = leaders_[static_cast<std::size_t>(k)];
      if (leader == 0) {
        leader = row;
        return true;
      }
      row ^= leader;
    }
    return false;
  }

 private:
  std::array<std::uint32_t, bits> leaders_{};
};

/// Nested uniform scrambling: a digit is flipped or not by chance, and that chance is one for all
/// points that agree in the digits before it (Owen 1995).
std::uint32_t scrambled(std::uint32_t x, std::uint64_t seed) {
  std::uint32_t out = 0;
  for (int r = 0; r < bits; ++r) {
    const std::uint64_t before = r == 0 ? 0 : x >> (bits - r);
    const std::uint64_t place = (std::uint64_t{1} << r) + before;  // of the node in the tree
    out |= ((x >> (bits - 1 - r) & 1u) ^ static_cast<std::uint32_t>(mixed(seed ^ place) & 1u))
           << (bits - 1 - r);
  }
  return out;
}

}  // namespace

std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

LowDiscrepancy::LowDiscrepancy(std::size_t dimensions, std::uint64_t seed) : seed_(seed) {
  if (dimensions == 0 || dimensions > most_dimensions)
    throw std::invalid_argument("LowDiscrepancy: 1 to 40 dimensions");
  Directions first;  // van der Corput's sequence
  for (int k = 0; k < bits; ++k) first.push_back(1u << (bits - 1 - k));
  directions_.push_back(first);
  constexpr std::uint64_t candidates = 16;
  constexpr std::array looked_at{4, 6, 8, 10};  // of 16, 64, 256 and 1024 points
  for (const BinaryPolynomial& p : primitive_polynomials(dimensions - 1)) {
    Directions best;
    std::int64_t least = 0;
    for (std::uint64_t c = 0; c < candidates; ++c) {
      Directions one = directions_from(p, p.coefficients * candidates + c);
      std::int64_t unevenness = 0;
      for (const Directions& before : directions_)
        for (const int m : looked_at)
          unevenness += std::int64_t{1} << (m - strength(before, one, m));
      if (!best.empty() && unevenness >= least) continue;
      best = std::move(one);
      least = unevenness;
    }
    directions_.push_back(std::move(best));
  }
}

int LowDiscrepancy::strength(const Directions& a, const Directions& b, int m) {
  int least = m;
  BinarySpan rows_of_a;
  for (int of_a = 0; of_a <= m; ++of_a) {
    BinarySpan both = rows_of_a;
    int of_b = 0;
    while (of_a + of_b < m && both.add(generator_row(b, of_b, m))) ++of_b;
    least = std::min(least, of_a + of_b);
    if (of_a < m) rows_of_a.add(generator_row(a, of_a, m));
  }
  return least;
}

int LowDiscrepancy::strength(std::size_t i, std::size_t j, int m) const {
  return strength(directions_[i], directions_[j], m);
}

Eigen::VectorXd LowDiscrepancy::point(std::uint32_t k) const {
  Eigen::VectorXd u(static_cast<Eigen::Index>(directions_.size()));
  for (std::size_t d = 0; d < directions_.size(); ++d) {
    std::uint32_t x = 0;
    for (int bit = 0; bit < bits; ++bit)
      if ((k >> bit & 1u) != 0) x ^= directions_[d][static_cast<std::size_t>(bit)];
    const std::uint64_t own = mixed(seed_ + 0x100000001b3ULL * (d + 1));
    u[static_cast<Eigen::Index>(d)] = (static_cast<double>(scrambled(x, own)) + 0.5) * 0x1p-32;
  }
  return u;
}

}  // namespace repose::study
