#include "models/batch_law.hpp"

#include <algorithm>
#include <cmath>

#include "models/objective.hpp"

namespace repose {
namespace {

/// A batch's points in arrays of their own, without the padding.
template <int N>
struct Gathered {
  static constexpr auto n = static_cast<std::size_t>(N);

  Gathered(const BatchOf<N>& batch, std::size_t state_variables)
      : count(batch.count),
        stress(n * count),
        state(state_variables * count),
        density(batch.density, batch.density + count) {
    for (std::size_t k = 0; k < n; ++k)
      std::copy_n(batch.stress[k], count, stress.data() + k * count);
    for (std::size_t k = 0; k < state_variables; ++k)
      std::copy_n(batch.state[k], count, state.data() + k * count);
  }
  PointArrays arrays(double dt) { return {count, n, dt, strain, density, stress, state}; }

  std::size_t count;
  std::vector<double> stress, state, density, strain;
};

/// Into an array of a batch, whose entries behind `count` repeat the last point.
void scatter(const double* from, std::size_t count, double* to) {
  std::copy_n(from, count, to);
  std::fill(to + count, to + padded(count), from[count - 1]);
}

}  // namespace

template <int N>
UpdateReport BatchLaw::update_all(const BatchOf<N>& batch) const {
  UpdateReport report;
  if (batch.count == 0) return report;
  const std::size_t count = batch.count;
  constexpr auto n = static_cast<std::size_t>(N);
  Gathered<N> points(batch, info_.state.size());
  points.strain.resize(n * count);
  std::vector<double> volume_strain(count);
  for (std::size_t k = 0; k < n; ++k)
    std::copy_n(batch.strain[k], count, points.strain.data() + k * count);
  const auto stress_of = [&](std::size_t i) {
    Sym<double, N> stress;
    for (std::size_t k = 0; k < n; ++k) stress.c[k] = points.stress[k * count + i];
    return stress;
  };
  for (std::size_t i = 0; i < count; ++i) {
    volume_strain[i] = points.strain[i] + points.strain[count + i] + points.strain[2 * count + i];
    // ρ after the step: d ln ρ = −tr D dt, exact for a constant rate of logarithmic strain
    points.density[i] *= std::exp(-volume_strain[i]);
    if (batch.spin[0] == nullptr) continue;
    Sym<double, N> stress = stress_of(i);
    if constexpr (N == 4)
      stress = rotated_in_plane(stress, batch.spin[0][i]);
    else
      stress = rotated(stress, {batch.spin[0][i], batch.spin[1][i], batch.spin[2][i]});
    for (std::size_t k = 0; k < n; ++k) points.stress[k * count + i] = stress.c[k];
  }
  const std::vector<double> before = points.stress;
  advance(points.arrays(batch.dt));

  std::vector<double> work(count), none(count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    Sym<double, N> mean, strain;
    bool sound = batch.dt >= 0.0 && points.density[i] > 0.0 && std::isfinite(points.density[i]);
    for (std::size_t k = 0; k < n; ++k) {
      const double old = before[k * count + i], now = points.stress[k * count + i];
      mean.c[k] = 0.5 * (old + now);
      strain.c[k] = points.strain[k * count + i];
      sound = sound && std::isfinite(now) && std::isfinite(old) && std::isfinite(strain.c[k]);
    }
    for (std::size_t k = 0; k < info_.state.size(); ++k)
      sound = sound && std::isfinite(points.state[k * count + i]);
    work[i] = sound ? contract(mean, strain) : 0.0;
    if (sound) continue;
    if (report.ok()) report.failed = i;
    points.density[i] = batch.density[i];
    for (std::size_t k = 0; k < n; ++k) {
      points.stress[k * count + i] = batch.stress[k][i];
      points.strain[k * count + i] = 0.0;
    }
    for (std::size_t k = 0; k < info_.state.size(); ++k)
      points.state[k * count + i] = batch.state[k][i];
  }
  for (std::size_t k = 0; k < n; ++k)
    scatter(points.stress.data() + k * count, count, batch.stress[k]);
  for (std::size_t k = 0; k < info_.state.size(); ++k)
    scatter(points.state.data() + k * count, count, batch.state[k]);
  scatter(points.density.data(), count, batch.density);
  if (batch.work != nullptr) scatter(work.data(), count, batch.work);
  // what the law dissipates it does not say: it appears as work_residual in the ledger
  for (double* const spent : {batch.plastic, batch.viscous, batch.hypoelastic, batch.separation})
    if (spent != nullptr) scatter(none.data(), count, spent);
  std::vector<double> answer(count);
  if (batch.modulus != nullptr) {
    wave_modulus(points.arrays(batch.dt), answer.data());
    scatter(answer.data(), count, batch.modulus);
  }
  if (batch.viscosity != nullptr) {
    step_viscosity(points.arrays(batch.dt), answer.data());
    scatter(answer.data(), count, batch.viscosity);
  }
  return report;
}

template <int N, class F>
void BatchLaw::ask(const BatchOf<N>& batch, double* answer, F&& question) const {
  if (batch.count == 0) return;
  Gathered<N> points(batch, info_.state.size());
  std::vector<double> values(batch.count);
  question(points.arrays(0.0), values.data());
  scatter(values.data(), batch.count, answer);
}

UpdateReport BatchLaw::update(const Batch& batch) const { return update_all(batch); }
UpdateReport BatchLaw::update(const SpatialBatch& batch) const { return update_all(batch); }

void BatchLaw::stored_energy(const Batch& batch, double* stored) const {
  ask(batch, stored, [&](const PointArrays& points, double* out) { energy(points, out); });
}
void BatchLaw::stored_energy(const SpatialBatch& batch, double* stored) const {
  ask(batch, stored, [&](const PointArrays& points, double* out) { energy(points, out); });
}
void BatchLaw::modulus(const Batch& batch, double* rho_c2) const {
  ask(batch, rho_c2, [&](const PointArrays& points, double* out) { wave_modulus(points, out); });
}
void BatchLaw::modulus(const SpatialBatch& batch, double* rho_c2) const {
  ask(batch, rho_c2, [&](const PointArrays& points, double* out) { wave_modulus(points, out); });
}

void BatchLaw::elastic_volume_strain(const Batch&, double*) const {
  throw InputError("step.pressure_averaging",
                   std::string(info_.name) +
                       " does not say its elastic volume strain: pressure_averaging is for the "
                       "library's laws");
}
void BatchLaw::viscosity(const Batch&, double*, double*) const {
  throw InputError("step.viscosity", std::string(info_.name) +
                                         " acts by explicit forces: viscosity = \"implicit\" is "
                                         "for the library's laws");
}

}  // namespace repose
