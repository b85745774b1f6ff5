#pragma once
/// \file
/// Growth in plane shear measured with the Material Point Method: its sign against the criterion,
/// and its size under refinement. Rates are in units of ηk²/ρ.

#include "study/stability/part.hpp"

namespace repose::study {

/// K/p and ηk²/ρ over ck of the waves that judge the criterion: ηk²/ρ is a thousand γ̇, and the
/// pressure follows to 0.16.
inline constexpr double shear_cell_stiffness = 2500.0;
inline constexpr double shear_cell_acoustic_share = 0.4;

/// Growth over I of one form.
struct CellCurve {
  std::string form;
  std::vector<double> I, theory, measured;
};
/// Growth over (I, μ_d/μ_0).
struct CellMap {
  std::vector<double> I, ratio, measured, C;
};
/// One wave with more and more cells.
struct CellConvergence {
  double I;
  std::vector<double> cells, expected, measured;  ///< rates over that of theory
};
/// Waves of eight cells, ever finer: rates of growth, or of decay, over γ̇.
struct CellRefinement {
  bool growing;
  std::string name;
  std::vector<double> h_over_d, measured, theory;
};
/// A history of noise.
struct CellNoise {
  double I;
  bool coarsest;
  std::vector<double> time;  ///< times ηk²/ρ of waves of eight of the coarsest cells
  std::vector<double> log_size;
};

struct ShearCellMaps : PartMaps {
  std::vector<double> numbers;  ///< I that curves are measured at
  std::vector<CellCurve> curves;
  std::optional<CellMap> map;  ///< absent from quick maps
  double p = 0.0;              ///< [Pa]
  std::vector<CellConvergence> convergence;
  std::vector<CellRefinement> refinement;
  std::vector<CellNoise> noise;
  int points = 0, outside = 0;              ///< of the signs: all, and those outside the margin
  int agree_outside = 0, agree_inside = 0;  ///< signs of criterion and growth
};

/// Tables mu_i_shear_signs, mu_i_shear_refinement. A part of map_mu_i().
ShearCellMaps map_shear_cell(const input::StabilityInput& input);

}  // namespace repose::study
