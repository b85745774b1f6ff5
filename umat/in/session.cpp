/// One path of a UMAT.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "umat/in/point_law.hpp"

namespace repose::umat {
namespace {

/// DDSDDE counts as off from here, relative to the differences, in the norm of its components.
constexpr double tangent_tolerance = 0.1;

bool same(const Session::Call& a, const Session::Call& b) {
  return a.dt == b.dt && a.strain.c == b.strain.c && a.stress.c == b.stress.c && a.state == b.state;
}

}  // namespace

Session::Session(const Description& description, std::span<const double> props, bool checks)
    : description_(description),
      at_(layout_of(description)),
      props_(props.begin(),
             props.begin() + static_cast<std::ptrdiff_t>(description.library.nprops)),
      checks_(checks) {}

void Session::put(const Call& call, const Sym<double, 6>& strain, std::size_t i) {
  const Exchange& exchange = (*host_)->exchange();
  PointRecord& record = exchange.point(i);
  put_stress(call.stress, record.stress);
  put_strain(strain, record.dstran);
  Sym<double, 6> total;
  for (int c = 0; c < 6; ++c)
    total[c] = call.state[at_.own(strain_xx) + static_cast<std::size_t>(c)];
  put_strain(total, record.stran);
  std::fill_n(record.drot, 9, 0.0);
  record.drot[0] = record.drot[4] = record.drot[8] = 1.0;
  record.time[0] = record.time[1] = call.state[at_.own(elapsed)];
  record.dtime = call.dt;
  record.sse = call.state[at_.own(stored)];
  record.spd = call.state[at_.own(spent)];
  record.pnewdt = 1.0;
  record.kinc = static_cast<std::int32_t>(call.state[at_.own(increments)]) + 1;
  record.noel = 1;
  std::copy_n(call.state.begin(), at_.nstatv, exchange.statev(i));
}

bool Session::run(std::size_t count) {
  try {
    (*host_)->run(count, 6, false);
    return true;
  } catch (const Failure& failure) {
    failure_ = failure;
    if (!(*host_)->alive()) host_.reset();
    return false;
  }
}

const Session::Answer* Session::update(const Call& call) {
  if (has_answer_ && same(call, last_)) return &answer_;
  if (failure_) return nullptr;
  has_answer_ = false;
  for (const double x : call.strain.c)
    if (!std::isfinite(x)) return nullptr;
  try {
    if (!host_) {
      host_.emplace(description_.library);
      std::copy(props_.begin(), props_.end(), (*host_)->exchange().props());
    }
  } catch (const Failure& failure) {
    failure_ = failure;
    return nullptr;
  }
  put(call, call.strain, 0);
  if (!run(1)) return nullptr;
  const PointRecord& record = (*host_)->exchange().point(0);
  wants_less_ = record.pnewdt < 1.0;
  if (wants_less_) return nullptr;
  last_ = call;
  answer_.stress = stress_from<6>(record.stress);
  answer_.state = call.state;
  std::copy_n((*host_)->exchange().statev(0), at_.nstatv, answer_.state.begin());
  for (int c = 0; c < 6; ++c)
    answer_.state[at_.own(strain_xx) + static_cast<std::size_t>(c)] += call.strain[c];
  answer_.state[at_.own(elapsed)] += call.dt;
  answer_.state[at_.own(increments)] += 1.0;
  answer_.state[at_.own(stored)] = record.sse;
  answer_.state[at_.own(spent)] = record.spd;
  std::copy_n(record.ddsdde, 36, answer_.ddsdde.begin());
  has_answer_ = true;
  return &answer_;
}

void Session::check_tangent() {
  if (!has_answer_ || failure_) return;
  double largest = 0.0;
  for (const double x : last_.strain.c) largest = std::max(largest, std::abs(x));
  if (!(largest > 0.0)) return;
  // central differences over a hundredth of the step: far above the noise of an update that cuts
  // its own steps, and within the curvature that a tangent has no part in
  const double h = 0.01 * largest;
  const Call here = last_;
  for (int j = 0; j < 6; ++j)
    for (const int sign : {0, 1}) {
      Sym<double, 6> strain = here.strain;
      strain[j] += sign == 0 ? h : -h;
      put(here, strain, static_cast<std::size_t>(2 * j + sign));
    }
  if (!run(12)) {
    // that the neighbourhood of a good step fails is no failure of the path
    failure_.reset();
    return;
  }
  double wrong = 0.0, size = 0.0;
  for (int j = 0; j < 6; ++j) {
    const PointRecord& up = (*host_)->exchange().point(static_cast<std::size_t>(2 * j));
    const PointRecord& down = (*host_)->exchange().point(static_cast<std::size_t>(2 * j + 1));
    if (up.pnewdt < 1.0 || down.pnewdt < 1.0) return;
    const auto above = stress_from<6>(up.stress), below = stress_from<6>(down.stress);
    for (int i = 0; i < 6; ++i) {
      const double slope = (above[i] - below[i]) / (2.0 * h);
      const double told = tangent<6>(answer_.ddsdde.data(), i, j);
      wrong += (slope - told) * (slope - told);
      size += slope * slope;
    }
  }
  ++tangents_checked;
  if (!(wrong <= tangent_tolerance * tangent_tolerance * size)) ++tangents_off;
}

}  // namespace repose::umat
