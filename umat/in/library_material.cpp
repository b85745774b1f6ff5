#include "umat/in/library_material.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "models/objective.hpp"
#include "umat/in/abaqus_order.hpp"
#include "umat/in/host_pool.hpp"
#include "umat/in/wave_modulus.hpp"

namespace repose::umat {
namespace {

/// The modulus of a point falls by no more than this share per step: plastic flow hides how stiff
/// the point is once it is unloaded, for which a step must be small enough as well.
constexpr double most_fall = 0.01;

/// What a tangent at rest is asked for with: the direction of a strain matters to some laws, so it
/// is not 0, and it changes no stress that matters.
constexpr double probing_strain = -1e-9;
constexpr double probing_time = 1e-6;  // [s]

template <int N>
Sym<double, N> gather(const auto& arrays, std::size_t first, std::size_t k) {
  Sym<double, N> a;
  for (int i = 0; i < N; ++i) a[i] = arrays[first + static_cast<std::size_t>(i)][k];
  return a;
}

/// The step's rotation, as a tensor and as the matrix DROT (column by column). Cayley's, as for the
/// stress (models/objective.hpp): the columns are the rotated axes.
template <int N>
struct Rotation {
  std::array<double, 3> theta{};
  bool any = false;

  Sym<double, N> operator()(const Sym<double, N>& a) const {
    if (!any) return a;
    if constexpr (N == 4)
      return rotated_in_plane(a, theta[2]);
    else
      return rotated(a, theta);
  }
  void put(double* drot) const {
    const double x = 0.5 * theta[0], y = 0.5 * theta[1], z = 0.5 * theta[2];
    const double f = 2.0 / (1.0 + x * x + y * y + z * z);
    const double R[9] = {
        1.0 - f * (y * y + z * z), f * (x * y + z),           f * (x * z - y),
        f * (x * y - z),           1.0 - f * (z * z + x * x), f * (y * z + x),
        f * (x * z + y),           f * (y * z - x),           1.0 - f * (x * x + y * y)};
    std::copy_n(R, 9, drot);
  }
};

template <int N>
Rotation<N> rotation_of(const BatchOf<N>& batch, std::size_t k) {
  Rotation<N> r;
  if (batch.spin[0] == nullptr) return r;
  r.any = true;
  if constexpr (N == 4)
    r.theta[2] = batch.spin[0][k];
  else
    r.theta = {batch.spin[0][k], batch.spin[1][k], batch.spin[2][k]};
  return r;
}

}  // namespace

template <int N>
void LibraryMaterial::pack(const BatchOf<N>& batch, std::size_t k, const Exchange& exchange,
                           std::size_t i) const {
  PointRecord& record = exchange.point(i);
  const Rotation<N> rotate = rotation_of(batch, k);
  put_stress(rotate(gather<N>(batch.stress, 0, k)), record.stress);
  if (batch.strain[0] != nullptr)  // else they are the caller's
    put_strain(gather<N>(batch.strain, 0, k), record.dstran);
  put_strain(rotate(gather<N>(batch.state, at_.own(strain_xx), k)), record.stran);
  rotate.put(record.drot);
  record.time[0] = record.time[1] = own(batch, elapsed)[k];
  record.dtime = batch.dt;
  record.sse = own(batch, stored)[k];
  record.spd = own(batch, spent)[k];
  record.kinc = static_cast<std::int32_t>(own(batch, increments)[k]) + 1;
  record.noel = 1;
  record.pnewdt = 1.0;
  for (std::size_t s = 0; s < at_.nstatv; ++s) exchange.statev(i)[s] = batch.state[s][k];
}

template <int N>
UpdateReport LibraryMaterial::update_all(const BatchOf<N>& batch) const {
  UpdateReport report;
  std::size_t first = 0;
  const auto not_done = [&](std::size_t point, std::string reason) {
    report.failed = point;
    report.reason = std::move(reason);
    // what is not done does no work
    for (double* const energy :
         {batch.work, batch.plastic, batch.viscous, batch.hypoelastic, batch.separation})
      if (energy != nullptr) std::fill(energy + first, energy + padded(batch.count), 0.0);
    if (batch.viscosity != nullptr)
      std::fill(batch.viscosity + first, batch.viscosity + padded(batch.count), 0.0);
    if (batch.modulus != nullptr)
      std::copy(own(batch, stiffness) + first, own(batch, stiffness) + padded(batch.count),
                batch.modulus + first);
  };
  for (std::size_t k = 0; k < batch.count; ++k) {
    double sum = batch.dt + batch.density[k];
    for (int c = 0; c < N; ++c) {
      const auto C = static_cast<std::size_t>(c);
      sum += batch.strain[C][k] + batch.stress[C][k];
    }
    if (!std::isfinite(sum) || !(batch.dt >= 0.0) || !(batch.density[k] > 0.0)) {
      not_done(k, "");
      return report;
    }
  }
  try {
    HostLease host(description_.library);
    for (std::size_t i = 0; i < at_.nprops; ++i) host->exchange().props()[i] = theta()[i];
    for (; first < batch.count; first += exchange_capacity) {
      const std::size_t count = std::min(exchange_capacity, batch.count - first);
      for (std::size_t i = 0; i < count; ++i) pack(batch, first + i, host->exchange(), i);
      host->run(count, N, true);
      update_part(batch, first, count, *host);
    }
  } catch (const Failure& failure) {
    not_done(std::min(first + failure.point(), batch.count - 1), failure.what());
    return report;
  }
  // what lies behind the points are copies of the last
  const std::size_t last = batch.count - 1;
  const auto spread = [&](double* values) {
    if (values != nullptr)
      std::fill(values + batch.count, values + padded(batch.count), values[last]);
  };
  for (double* const values : batch.stress) spread(values);
  for (std::size_t s = 0; s < info_.state.size(); ++s) spread(batch.state[s]);
  for (double* const values : {batch.density, batch.modulus, batch.viscosity, batch.work,
                               batch.plastic, batch.viscous, batch.hypoelastic, batch.separation})
    spread(values);
  return report;
}

template <int N>
void LibraryMaterial::update_part(const BatchOf<N>& batch, std::size_t first, std::size_t count,
                                  HostProcess& host) const {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = first + i;
    const PointRecord& record = host.exchange().point(i);
    const Rotation<N> rotate = rotation_of(batch, k);
    const auto strain = gather<N>(batch.strain, 0, k);
    const Sym<double, N> before = rotate(gather<N>(batch.stress, 0, k));
    const Sym<double, N> after = stress_from<N>(record.stress);
    const Sym<double, N> total = rotate(gather<N>(batch.state, at_.own(strain_xx), k)) + strain;
    const double work = 0.5 * contract(before + after, strain);
    const double lost =
        spent_in_step(own(batch, spent)[k], record.spd, own(batch, stored)[k], record.sse, work);
    for (int c = 0; c < N; ++c) {
      batch.stress[static_cast<std::size_t>(c)][k] = after[c];
      batch.state[at_.own(strain_xx) + static_cast<std::size_t>(c)][k] = total[c];
    }
    for (std::size_t s = 0; s < at_.nstatv; ++s) batch.state[s][k] = host.exchange().statev(i)[s];
    own(batch, elapsed)[k] += batch.dt;
    own(batch, increments)[k] += 1.0;
    own(batch, stored)[k] = record.sse;
    own(batch, spent)[k] = record.spd;
    double& stiff = own(batch, stiffness)[k];
    stiff = std::max(wave_modulus<N>(record.ddsdde), (1.0 - most_fall) * stiff);
    batch.density[k] *= std::exp(-trace(strain));
    const auto put = [&](double* to, double x) {
      if (to != nullptr) to[k] = x;
    };
    put(batch.work, work);
    put(batch.plastic, lost);
    put(batch.viscous, 0.0);
    put(batch.hypoelastic, 0.0);
    put(batch.separation, 0.0);
    put(batch.modulus, stiff);
    put(batch.viscosity, 0.0);
  }
}

template <int N>
void LibraryMaterial::stored_in(const BatchOf<N>& batch, double* energy) const {
  std::copy_n(own(batch, stored), padded(batch.count), energy);
}

template <int N>
void LibraryMaterial::modulus_of(const BatchOf<N>& batch, double* rho_c2) const {
  const double* const known = own(batch, stiffness);
  std::copy_n(known, padded(batch.count), rho_c2);
  if (std::all_of(known, known + batch.count, [](double x) { return x > 0.0; })) return;
  try {
    probe(batch, rho_c2);
  } catch (const Failure&) {
    // it was well at its initial state; the first update meets the same, and can report it
  }
}

template <int N>
void LibraryMaterial::probe(const BatchOf<N>& batch, double* rho_c2) const {
  HostLease host(description_.library);
  for (std::size_t i = 0; i < at_.nprops; ++i) host->exchange().props()[i] = theta()[i];
  BatchOf<N> still = batch;
  still.strain = {};
  still.spin = {};
  still.dt = probing_time;
  for (std::size_t first = 0; first < batch.count; first += exchange_capacity) {
    const std::size_t count = std::min(exchange_capacity, batch.count - first);
    for (std::size_t i = 0; i < count; ++i) {
      pack(still, first + i, host->exchange(), i);
      PointRecord& record = host->exchange().point(i);
      std::fill_n(record.dstran, N, 0.0);
      std::fill_n(record.dstran, 3, probing_strain);
    }
    host->run(count, N, true);
    for (std::size_t i = 0; i < count; ++i)
      rho_c2[first + i] = std::max(own(batch, stiffness)[first + i],
                                   wave_modulus<N>(host->exchange().point(i).ddsdde));
  }
  std::fill(rho_c2 + batch.count, rho_c2 + padded(batch.count), rho_c2[batch.count - 1]);
}

void LibraryMaterial::elastic_volume_strain(const Batch& batch, double* strain) const {
  for (std::size_t k = 0; k < padded(batch.count); ++k)
    strain[k] =
        own(batch, strain_xx)[k] + own(batch, strain_xx + 1)[k] + own(batch, strain_xx + 2)[k];
}

void LibraryMaterial::viscosity(const Batch& batch, double* eta, double* thinning) const {
  std::fill_n(eta, padded(batch.count), 0.0);
  std::fill_n(thinning, padded(batch.count), 0.0);
}

InitialPoint LibraryMaterial::initial(const InitialConditions& given) const {
  InitialPoint point = initial_point(description_, theta(), given);
  if (!(point.density > 0.0)) point.density = density();
  // what fails at rest is better known before anything moves
  BatchOf<6> batch;
  batch.count = 1;
  std::vector<std::array<double, pack_size>> room(7 + point.state.size());
  const auto column = [&](std::size_t i, double x) {
    room[i].fill(x);
    return room[i].data();
  };
  for (std::size_t c = 0; c < 6; ++c) batch.stress[c] = column(c, point.stress.c[c]);
  batch.density = column(6, point.density);
  for (std::size_t s = 0; s < point.state.size(); ++s)
    batch.state[s] = column(7 + s, point.state[s]);
  std::array<double, pack_size> stiff{};
  try {
    probe(batch, stiff.data());
  } catch (const Failure& failure) {
    throw InputError("law", fmt::format("at rest under the initial stress {}", failure.what()));
  }
  if (!(stiff[0] > 0.0))
    throw InputError("law", fmt::format("{}: under the initial stress it returns a tangent DDSDDE "
                                        "without stiffness, so that nothing bounds the step",
                                        description_.library.file.string()));
  return point;
}

double LibraryMaterial::density() const {
  const double rho_0 = theta()[at_.rho_0()];
  if (std::isnan(rho_0))
    throw InputError(
        "rho_0",
        "a body of umat needs its density: rho_0 in its law, or rho_p there with v or e "
        "in its initial state");
  return rho_0;
}

double LibraryMaterial::density_at(double, double) const { return density(); }

}  // namespace repose::umat
