#pragma once
/// \file
/// The distribution of what fine runs give, from a few of them and many coarse ones of the same
/// draws: regression on a quicker quantity whose own distribution is well known (double sampling,
/// Cochran 1977, chapter 12; as multifidelity Monte Carlo, Peherstorfer, Willcox & Gunzburger
/// 2018).

#include <array>
#include <vector>

#include <Eigen/Core>

namespace repose::study {

/// Fewest pairs of a coarse and a fine run: two for the line, and two for what it misses.
inline constexpr Eigen::Index fewest_pairs = 4;

/// With f = a + b c + e over the n pairs, s² = Σe²/(n − 2), and c over all N draws. NaN where there
/// are too few pairs.
struct Propagated {
  Eigen::Index draws = 0;    ///< N, that have a coarse value
  Eigen::Index pairs = 0;    ///< n, that have both
  double correlation = 0.0;  ///< of fine and coarse
  double mean = 0.0;         ///< a + b c̄
  /// Of the mean: √(s²/n + s² (c̄ − c̄_n)²/S_cc + b² s_c²/N)
  double standard_error = 0.0;
  double deviation = 0.0;               ///< √(b² s_c² + s²)
  double median = 0.0;                  ///< of all a + b c_j + e_k, e as long as s says
  std::array<double, 2> interval_90{};  ///< the same
  double coarse_mean = 0.0;             ///< c̄
  double change = 0.0;                  ///< mean − c̄: what the finer cells move
  /// So many fine runs alone would give the mean as well: deviation²/standard_error²
  double worth = 0.0;
};

/// coarse: of every draw; fine: of the draws with these places. Values that are not finite are left
/// out. values: where given, it takes the a + b c_j + e_k in ascending order.
Propagated propagated(const Eigen::VectorXd& coarse, const std::vector<Eigen::Index>& places,
                      const Eigen::VectorXd& fine, std::vector<double>* values = nullptr);

}  // namespace repose::study
