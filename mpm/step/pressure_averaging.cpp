#include "mpm/step/pressure_averaging.hpp"

#include "models/scalar.hpp"

namespace repose::mpm {
namespace {

Pack load(const double* from) { return Pack::load_unaligned(from); }

Pack pressure_of(const Batch& batch, std::size_t k) {
  return Pack(-1.0 / 3.0) *
         (load(batch.stress[0] + k) + load(batch.stress[1] + k) + load(batch.stress[2] + k));
}

}  // namespace

void add_averaging_strain(const Material& material, const Batch& batch, double rate,
                          double* averaging, double* pressure_before,
                          const std::array<double*, 4>& strain) {
  double* const own = pressure_before;  // first the strains, then the pressures
  material.elastic_volume_strain(batch, own);
  const Pack minus_rate(-rate), third(1.0 / 3.0);
  for (std::size_t k = 0; k < batch.count; k += Pack::size) {
    Sym<Pack, 4> e;
    for (std::size_t i = 0; i < 4; ++i) e.c[i] = load(strain[i] + k);
    const Pack gamma = Pack(2.0) * shear_norm(deviator(e));  // γ̇Δt = √(2 Δε′:Δε′)
    const Pack share = -exp_pair(Pack(minus_rate * gamma)).minus_one;
    const Pack added = share * (load(averaging + k) - load(own + k));
    added.store_unaligned(averaging + k);
    pressure_of(batch, k).store_unaligned(pressure_before + k);
    for (std::size_t i = 0; i < 3; ++i) (e.c[i] + third * added).store_unaligned(strain[i] + k);
  }
}

void take_back_averaging_work(const Batch& batch, double* averaging,
                              const double* pressure_before) {
  for (std::size_t k = 0; k < batch.count; k += Pack::size) {
    const Pack p = load(pressure_before + k) + pressure_of(batch, k);
    const Pack taken = Pack(0.5) * p * load(averaging + k);
    (load(batch.work + k) + taken).store_unaligned(batch.work + k);
    taken.store_unaligned(averaging + k);
  }
}

}  // namespace repose::mpm
