#include "umat/in/host/umat_call.hpp"

#include <algorithm>
#include <cstring>

#include <unistd.h>

namespace repose::umat {
namespace {

/// Least share of an increment that is tried: 2^-20 of it, a million calls.
constexpr double least_part = 1.0 / 1048576.0;

/// Positions in scalars_.
enum Scalar : std::size_t {
  sse,
  spd,
  scd,
  rpl,
  drpldt,
  dtime,
  temp,
  dtemp,
  pnewdt,
  celent,
  scalar_count
};
/// Positions in integers_; JSTEP is four numbers, the first of which is KSTEP of older manuals.
enum Integer : std::size_t {
  ndi,
  nshr,
  ntens,
  nstatv,
  nprops,
  noel,
  npt,
  layer,
  kspt,
  kinc,
  jstep,
  integer_count = jstep + 4
};

void identity(double* matrix) {
  std::fill_n(matrix, 9, 0.0);
  matrix[0] = matrix[4] = matrix[8] = 1.0;
}

}  // namespace

UmatCall::UmatCall(UmatFunction* function, const Header& header, const char* cmname)
    : function_(function),
      ntens_(header.ntens),
      stress_("STRESS", header.ntens),
      statev_("STATEV", header.nstatv),
      ddsdde_("DDSDDE", std::size_t{header.ntens} * header.ntens),
      ddsddt_("DDSDDT", header.ntens),
      drplde_("DRPLDE", header.ntens),
      stran_("STRAN", header.ntens),
      dstran_("DSTRAN", header.ntens),
      time_("TIME", 2),
      predef_("PREDEF", 1),
      dpred_("DPRED", 1),
      props_("PROPS", header.nprops),
      coords_("COORDS", 3),
      drot_("DROT", 9),
      dfgrd0_("DFGRD0", 9),
      dfgrd1_("DFGRD1", 9),
      scalars_("the scalar arguments", scalar_count),
      integers_("the integer arguments", (integer_count + 1) / 2),
      cmname_("CMNAME", 10),
      all_{&stress_, &statev_, &ddsdde_, &ddsddt_,  &drplde_,   &stran_,
           &dstran_, &time_,   &predef_, &dpred_,   &props_,    &coords_,
           &drot_,   &dfgrd0_, &dfgrd1_, &scalars_, &integers_, &cmname_},
      kept_statev_(header.nstatv),
      self_(::getpid()) {
  name_.fill(' ');
  std::memcpy(name_.data(), cmname, std::min(name_.size(), std::strlen(cmname)));
}

void UmatCall::call(const Header& header, const double* props, const PointRecord& record,
                    double done, double part) {
  std::fill_n(ddsdde_.data(), ntens_ * ntens_, 0.0);
  std::fill_n(ddsddt_.data(), ntens_, 0.0);
  std::fill_n(drplde_.data(), ntens_, 0.0);
  for (std::size_t i = 0; i < ntens_; ++i) {
    stran_.data()[i] = record.stran[i] + done * record.dstran[i];
    dstran_.data()[i] = part * record.dstran[i];
  }
  for (std::size_t i = 0; i < 2; ++i) time_.data()[i] = record.time[i] + done * record.dtime;
  predef_.data()[0] = dpred_.data()[0] = 0.0;
  std::copy_n(props, header.nprops, props_.data());
  std::fill_n(coords_.data(), 3, 0.0);
  // the rotation belongs to the whole increment and comes with its first part
  if (done == 0.0)
    std::copy_n(record.drot, 9, drot_.data());
  else
    identity(drot_.data());
  identity(dfgrd0_.data());
  identity(dfgrd1_.data());
  double* const scalar = scalars_.data();
  scalar[scd] = scalar[rpl] = scalar[drpldt] = scalar[temp] = scalar[dtemp] = 0.0;
  scalar[dtime] = part * record.dtime;
  scalar[pnewdt] = scalar[celent] = 1.0;
  int* const integer = reinterpret_cast<int*>(integers_.data());
  integer[ndi] = 3;
  integer[ntens] = static_cast<int>(ntens_);
  integer[nshr] = integer[ntens] - 3;
  integer[nstatv] = static_cast<int>(header.nstatv);
  integer[nprops] = static_cast<int>(header.nprops);
  integer[noel] = record.noel;
  integer[npt] = integer[layer] = integer[kspt] = 1;
  integer[kinc] = record.kinc;
  std::fill_n(integer + jstep, 4, 0);
  integer[jstep] = 1;
  char* const name = reinterpret_cast<char*>(cmname_.data());
  std::copy(name_.begin(), name_.end(), name);
  function_(stress_.data(), statev_.data(), ddsdde_.data(), scalar + sse, scalar + spd,
            scalar + scd, scalar + rpl, ddsddt_.data(), drplde_.data(), scalar + drpldt,
            stran_.data(), dstran_.data(), time_.data(), scalar + dtime, scalar + temp,
            scalar + dtemp, predef_.data(), dpred_.data(), name, integer + ndi, integer + nshr,
            integer + ntens, integer + nstatv, props_.data(), integer + nprops, coords_.data(),
            drot_.data(), scalar + pnewdt, scalar + celent, dfgrd0_.data(), dfgrd1_.data(),
            integer + noel, integer + npt, integer + layer, integer + kspt, integer + jstep,
            integer + kinc, name_.size());
  // a child that the library has forked comes back here as well: two must not serve, nor may it
  // write what it has into the record
  if (::getpid() != self_) ::_exit(0);
}

Fault UmatCall::run(const Header& header, const double* props, PointRecord& record,
                    double* statev) {
  double* const scalar = scalars_.data();
  std::array<double, 6> kept_stress{};
  std::copy_n(record.stress, ntens_, kept_stress.begin());
  std::copy_n(statev, header.nstatv, kept_statev_.begin());
  double kept_sse = record.sse, kept_spd = record.spd;
  double done = 0.0, part = 1.0;
  for (;;) {
    std::copy_n(kept_stress.begin(), ntens_, stress_.data());
    std::copy_n(kept_statev_.begin(), header.nstatv, statev_.data());
    scalar[sse] = kept_sse;
    scalar[spd] = kept_spd;
    call(header, props, record, done, part);
    if (damaged() != nullptr) return Fault::beyond_array;
    record.pnewdt = scalar[pnewdt];
    const bool too_large = record.pnewdt < 1.0;
    if (too_large && header.subdivide != 0) {
      part *= std::clamp(record.pnewdt, 0.1, 0.9);
      if (part < least_part) return Fault::not_converged;
      continue;
    }
    done += part;
    if (too_large || !(done < 1.0)) break;
    part = std::min(part, 1.0 - done);
    std::copy_n(stress_.data(), ntens_, kept_stress.begin());
    std::copy_n(statev_.data(), header.nstatv, kept_statev_.begin());
    kept_sse = scalar[sse];
    kept_spd = scalar[spd] + scalar[scd];
  }
  std::copy_n(stress_.data(), ntens_, record.stress);
  std::copy_n(statev_.data(), header.nstatv, statev);
  std::copy_n(ddsdde_.data(), ntens_ * ntens_, record.ddsdde);
  record.sse = scalar[sse];
  record.spd = scalar[spd] + scalar[scd];
  return Fault::none;
}

const GuardedArray* UmatCall::guarding(const void* address) const {
  for (const GuardedArray* array : all_)
    if (array->guards(address)) return array;
  return nullptr;
}

const GuardedArray* UmatCall::damaged() const {
  for (const GuardedArray* array : all_)
    if (!array->intact()) return array;
  return nullptr;
}

}  // namespace repose::umat
