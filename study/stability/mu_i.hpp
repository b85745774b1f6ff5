#pragma once
/// \file
/// Where μ(I) is ill-posed: the criterion against the growth of noise, what bounds it, and where a
/// collapse meets it. Growth is in units of ηk²/ρ where nothing else is said.

#include "study/stability/shear_cell.hpp"

namespace repose::study {

/// Growth over I and a second number of the law, with all else as given.
struct GrowthMap {
  bool ratio;         ///< the second number is μ_d/μ_0; else μ_0
  double mu_0, mu_d;  ///< of the law as given
  std::vector<double> I, second, C, measured;
};
/// Fastest growth over the wavelength for one bulk modulus.
struct GrowthSpectrum {
  double K = 0.0;  ///< [Pa]
  std::vector<double> wavelength_over_d, rate_over_shear_rate;
};
/// Fastest growth over I of one form.
struct GrowthCurve {
  std::string form;
  std::vector<double> I, predicted, measured;
};
/// Fastest growth of the regularised form over r/γ̇, at one I.
struct GrowthOverR {
  double I = 0.0;
  std::vector<double> ratio, predicted, measured;
};
/// Ill-posed points of the paper's column as it collapses.
struct IllPosedCollapse {
  double h = 0.0, point_spacing = 0.0;                     ///< [m]
  std::vector<double> time, flowing_percent, ill_percent;  ///< shares of the mass over time [s]
  double shown_time = 0.0;                                 ///< of the points below [s]
  std::vector<double> x_m, y_m, C;                         ///< NaN: no flow
};

struct GrainMaps : PartMaps {
  double p = 0.0;  ///< [Pa]
  std::vector<GrowthMap> boundary;
  double spectrum_I = 0.0;
  std::vector<GrowthSpectrum> spectra;
  GrowthSpectrum incompressible;  ///< of all their wavelengths, by formula; K says nothing
  std::vector<double> numbers;    ///< I of the curves
  std::vector<GrowthCurve> curves;
  GrowthOverR over_r;
  ShearCellMaps shear_cell;  ///< its tables and figures are among these
  IllPosedCollapse collapse;
  int points = 0, outside = 0;              ///< of the boundary: all, and those outside the margin
  int agree_outside = 0, agree_inside = 0;  ///< signs of criterion and growth
};

/// Tables mu_i_boundary, mu_i_refinement, mu_i_curves, those of map_shear_cell(), mu_i_collapse.
/// Throws InputError.
GrainMaps map_mu_i(const input::StabilityInput& input);

/// What is said of the maps, a line each.
std::string words_of(const GrainMaps& maps);

}  // namespace repose::study
