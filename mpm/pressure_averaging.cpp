#include "mpm/pressure_averaging.hpp"

#include <cmath>

namespace repose::mpm {
namespace {

double pressure_of(const Batch& batch, std::size_t k) {
  return -(batch.stress[0][k] + batch.stress[1][k] + batch.stress[2][k]) / 3.0;
}

/// γ̇Δt = √(2 Δε′:Δε′)
double shear_strain(const std::array<double*, 4>& strain, std::size_t k) {
  const double mean = (strain[0][k] + strain[1][k] + strain[2][k]) / 3.0;
  const double xx = strain[0][k] - mean;
  const double yy = strain[1][k] - mean;
  const double zz = strain[2][k] - mean;
  const double xy = strain[3][k];
  return std::sqrt(2.0 * (xx * xx + yy * yy + zz * zz + 2.0 * xy * xy));
}

}  // namespace

void add_averaging_strain(const Material& material, const Batch& batch, double rate,
                          double* averaging, double* pressure_before,
                          const std::array<double*, 4>& strain) {
  double* const own = pressure_before;  // first the strains, then the pressures
  material.elastic_volume_strain(batch, own);
  for (std::size_t k = 0; k < batch.count; ++k) {
    const double share = -std::expm1(-rate * shear_strain(strain, k));
    averaging[k] = share * (averaging[k] - own[k]);
    pressure_before[k] = pressure_of(batch, k);
    for (std::size_t i = 0; i < 3; ++i) strain[i][k] += averaging[k] / 3.0;
  }
}

void take_back_averaging_work(const Batch& batch, const double* averaging,
                              const double* pressure_before) {
  for (std::size_t k = 0; k < batch.count; ++k)
    batch.work[k] += 0.5 * (pressure_before[k] + pressure_of(batch, k)) * averaging[k];
}

}  // namespace repose::mpm
