#include <cmath>

#include "models/law.hpp"

namespace repose {

Sym<double, 6> initial_stress(const InitialConditions& given, double default_p) {
  Sym<double, 6> stress;
  if (given.sigma) {
    if (given.p) throw InputError("sigma", "give either sigma or p: sigma already fixes p");
    if (given.K0) throw InputError("K0", "give either sigma or K0: sigma already fixes the ratio");
    if (given.sigma_v)
      throw InputError("sigma_v", "give either sigma or sigma_v: sigma already fixes it");
    for (int i = 0; i < 6; ++i) {
      const double x = (*given.sigma)[static_cast<std::size_t>(i)];
      if (!std::isfinite(x)) throw InputError("sigma", "every component of sigma must be finite");
      stress[i] = -x;
    }
    return stress;
  }
  if (given.sigma_v && given.p)
    throw InputError("sigma_v", "give either p or sigma_v: p = sigma_v (1 + 2 K0)/3");
  if (given.sigma_v && !given.K0)
    throw InputError("sigma_v",
                     "sigma_v needs K0 = sigma_horizontal/sigma_vertical (K0 = 1 for an "
                     "isotropic state)");
  if (given.sigma_v && !(*given.sigma_v > 0.0 && std::isfinite(*given.sigma_v)))
    throw InputError("sigma_v", "sigma_v must be > 0 Pa");
  const double p =
      given.sigma_v ? *given.sigma_v * (1.0 + 2.0 * *given.K0) / 3.0 : given.p.value_or(default_p);
  if (!std::isfinite(p)) throw InputError("p", "p must be a finite pressure in Pa");
  const double K0 = given.K0.value_or(1.0);
  if (!(K0 > 0.0) || !std::isfinite(K0))
    throw InputError("K0", "K0 = sigma_horizontal/sigma_vertical must be > 0");
  // p = σ_v(1 + 2K0)/3
  const double vertical = 3.0 * p / (1.0 + 2.0 * K0);
  stress[0] = stress[2] = -K0 * vertical;
  stress[1] = -vertical;
  return stress;
}

void reject_unused(std::string_view law, const InitialConditions& given, bool takes_ocr,
                   bool takes_v) {
  if (given.ocr && !takes_ocr)
    throw InputError("ocr", std::string(law) + " has no preconsolidation pressure: leave ocr out");
  if ((given.ocr_v || given.K0_nc) && !takes_ocr)
    throw InputError(given.ocr_v ? "ocr_v" : "K0_nc",
                     std::string(law) + " has no preconsolidation pressure: leave " +
                         (given.ocr_v ? "ocr_v" : "K0_nc") + " out");
  if (given.v && !takes_v)
    throw InputError(
        "v", std::string(law) + " starts from p, sigma or density, not from a specific volume");
  if (given.density && !(*given.density > 0.0 && std::isfinite(*given.density)))
    throw InputError("density", "density must be > 0 kg/m³");
}

}  // namespace repose
