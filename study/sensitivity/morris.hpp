#pragma once
/// \file
/// Elementary effects: which inputs matter at all, from few runs (Morris 1991).

#include "study/sensitivity/bootstrap.hpp"

namespace repose::study {

/// Trajectories through a grid of `levels` (even) values of each input, 0 to 1. Each begins at
/// random and moves one input after the other, in random order, up or down by Δ = levels/(2 (levels
/// − 1)). Row t (inputs + 1) + k is point k of trajectory t, which depends on seed and t alone.
Eigen::MatrixXd morris_points(int inputs, int trajectories, int levels, std::uint64_t seed);

/// What one input does: the effects are (y after − y before)/Δ, the change of the output over the
/// whole range of the input as far as it is even.
struct ElementaryEffects {
  Bounded mean_size;       ///< μ*, mean of |effect| (Campolongo, Cariboni & Saltelli 2007)
  double mean = 0.0;       ///< μ
  Bounded spread;          ///< σ, standard deviation: curvature, and interaction with other inputs
  Eigen::Index count = 0;  ///< effects that were found
};

/// y: of every row of points; an effect with a y that is not finite is left out. Intervals are
/// those of trajectories drawn again. Fewer than two effects of an input: NaN.
std::vector<ElementaryEffects> elementary_effects(const Eigen::MatrixXd& points,
                                                  const Eigen::VectorXd& y, std::uint64_t seed);

}  // namespace repose::study
