#include "models/tangent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "models/all_laws.hpp"
#include "models/objective.hpp"
#include "models/point_tangent.hpp"
#include "models/registry.hpp"

namespace repose {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

template <int N>
Sym<double, N> rotated_stress(const BatchOf<N>& batch, std::size_t i) {
  Sym<double, N> stress;
  for (std::size_t k = 0; k < batch.components; ++k) stress.c[k] = batch.stress[k][i];
  if (batch.spin[0] == nullptr) return stress;
  if constexpr (N == 4)
    return rotated_in_plane(stress, batch.spin[0][i]);
  else
    return rotated(stress, {batch.spin[0][i], batch.spin[1][i], batch.spin[2][i]});
}

void fail(UpdateReport& report, std::size_t i, double* at, std::size_t count) {
  if (report.ok()) report.failed = i;
  std::fill(at, at + count, not_a_number);
}

template <class L, int N>
UpdateReport in_duals(std::span<const double> theta, const BatchOf<N>& batch, double* tangent) {
  using D = Dual<N>;
  constexpr auto n = static_cast<std::size_t>(N);
  const std::vector<D> constants(theta.begin(), theta.end());
  const auto P = L::template Params<D>::from(std::span<const D>(constants));
  std::array<double, L::state.size()> state{};
  UpdateReport report;
  for (std::size_t i = 0; i < batch.count; ++i) {
    Sym<double, N> strain;
    for (std::size_t k = 0; k < n; ++k) strain.c[k] = batch.strain[k][i];
    for (std::size_t k = 0; k < state.size(); ++k) state[k] = batch.state[k][i];
    double* const at = tangent + i * n * n;
    Tangent<N> found;
    if (point_tangent<L, N>(P, strain, batch.dt, batch.density[i], rotated_stress(batch, i), state,
                            found))
      for (std::size_t a = 0; a < n; ++a) std::copy_n(found[a].begin(), n, at + a * n);
    else
      fail(report, i, at, n * n);
  }
  return report;
}

/// One padded batch of 2N points for each point: the step with one component moved up or down.
template <int N>
UpdateReport by_differences(const Material& material, const BatchOf<N>& batch, double* tangent) {
  constexpr auto n = static_cast<std::size_t>(N);
  constexpr std::size_t room = padded(2 * n);
  constexpr double delta = 1e-7;
  std::array<std::array<double, room>, n> strain{}, stress{};
  std::vector<std::array<double, room>> state(material.law().state.size());
  std::array<double, room> density{};
  UpdateReport report;
  for (std::size_t i = 0; i < batch.count; ++i) {
    const Sym<double, N> before = rotated_stress(batch, i);
    BatchOf<N> moved;
    moved.count = 2 * n;
    moved.dt = batch.dt;
    for (std::size_t k = 0; k < n; ++k) {
      strain[k].fill(batch.strain[k][i]);
      stress[k].fill(before.c[k]);
      strain[k][2 * k] += delta;
      strain[k][2 * k + 1] -= delta;
      moved.strain[k] = strain[k].data();
      moved.stress[k] = stress[k].data();
    }
    for (std::size_t k = 0; k < state.size(); ++k) {
      state[k].fill(batch.state[k][i]);
      moved.state[k] = state[k].data();
    }
    density.fill(batch.density[i]);
    moved.density = density.data();
    double* const at = tangent + i * n * n;
    if (!material.update(moved).ok()) {
      fail(report, i, at, n * n);
      continue;
    }
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b)
        at[a * n + b] = (stress[a][2 * b] - stress[a][2 * b + 1]) / (2.0 * delta);
  }
  return report;
}

template <int N>
UpdateReport tangent_of(const Material& material, const BatchOf<N>& batch, double* tangent) {
  return visit_law(
      material.law(), [&]<class L>(L) { return in_duals<L, N>(material.theta(), batch, tangent); },
      [&] { return by_differences(material, batch, tangent); });
}

}  // namespace

UpdateReport consistent_tangent(const Material& material, const Batch& batch, double* tangent) {
  return tangent_of(material, batch, tangent);
}
UpdateReport consistent_tangent(const Material& material, const SpatialBatch& batch,
                                double* tangent) {
  return tangent_of(material, batch, tangent);
}

}  // namespace repose
