#pragma once
/// \file
/// umat_ as a program calls it that is written in C++, and materials for it.

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "tests/models/law_samples.hpp"
#include "tests/umat/out/umat_props.hpp"
#include "umat/out/material_name.hpp"

extern "C" void umat_(double* stress, double* statev, double* ddsdde, double* sse, double* spd,
                      double* scd, double* rpl, double* ddsddt, double* drplde, double* drpldt,
                      const double* stran, const double* dstran, const double* time,
                      const double* dtime, const double* temp, const double* dtemp,
                      const double* predef, const double* dpred, const char* cmname, const int* ndi,
                      const int* nshr, const int* ntens, const int* nstatv, const double* props,
                      const int* nprops, const double* coords, const double* drot, double* pnewdt,
                      const double* celent, const double* dfgrd0, const double* dfgrd1,
                      const int* noel, const int* npt, const int* layer, const int* kspt,
                      const int* kstep, const int* kinc, std::size_t cmname_length);

namespace repose::umat {

/// What a finite element program keeps of an integration point, and what it gives and gets.
struct Host {
  std::string name;
  std::vector<double> props;
  int nshr = 3;
  std::vector<double> stress, statev, ddsdde;
  double sse = 0.0, spd = 0.0, scd = 0.0, pnewdt = 1e10;

  Host(std::string material, std::vector<double> constants, std::size_t states, int shears = 3)
      : name(std::move(material)),
        props(std::move(constants)),
        nshr(shears),
        stress(components(), 0.0),
        statev(states, 0.0),
        ddsdde(components() * components(), 0.0) {}

  std::size_t components() const { return static_cast<std::size_t>(3 + nshr); }

  /// One call; true where the step was done.
  bool step(const std::vector<double>& dstran, double dtime) {
    const std::vector<double> zeros(36, 0.0);
    std::vector<double> unused(36, 0.0);
    std::string padded = name;
    padded.resize(80, ' ');
    const int ndi = 3, ntens = 3 + nshr, nstatv = static_cast<int>(statev.size()), one = 1;
    const int nprops = static_cast<int>(props.size()), element = 12, integration_point = 5;
    double* const u = unused.data();
    const double* const z = zeros.data();
    pnewdt = 1e10;
    umat_(stress.data(), statev.data(), ddsdde.data(), &sse, &spd, &scd, u, u, u, u, z,
          dstran.data(), z, &dtime, z, z, z, z, padded.data(), &ndi, &nshr, &ntens, &nstatv,
          props.data(), &nprops, z, z, &pnewdt, z, z, z, &element, &integration_point, &one, &one,
          &one, &one, padded.size());
    return !(pnewdt < 1.0);
  }

  /// To the last bit.
  friend bool same_bits(const Host& a, const Host& b) {
    const auto same = [](const std::vector<double>& x, const std::vector<double>& y) {
      return x.size() == y.size() && std::memcmp(x.data(), y.data(), 8 * x.size()) == 0;
    };
    return same(a.stress, b.stress) && same(a.statev, b.statev) && same(a.ddsdde, b.ddsdde) &&
           same({a.sse, a.spd, a.scd}, {b.sse, b.spd, b.scd});
  }
};

/// Where component i of the host stands in a repose tensor.
inline int component(std::size_t i) {
  constexpr std::array<int, 6> order{0, 1, 2, 3, 5, 4};
  return order[i];
}

/// The host's strain of a tensor: engineering shears.
inline std::vector<double> host_strain(const Sym<double, 6>& strain, std::size_t components) {
  std::vector<double> result(components);
  for (std::size_t i = 0; i < components; ++i)
    result[i] = (i < 3 ? 1.0 : 2.0) * strain[component(i)];
  return result;
}

/// A host's point in the state of a law's point.
template <class L>
Host host_of(const LawExample& example, const LawPoint<L>& point, int nshr) {
  Host host(material_name(find_law(example.spec)), props_of(example.spec), 1 + L::state.size(),
            nshr);
  for (std::size_t i = 0; i < host.components(); ++i) host.stress[i] = point.stress[component(i)];
  host.statev[0] = point.density;
  for (std::size_t k = 0; k < L::state.size(); ++k) host.statev[1 + k] = point.state[k];
  return host;
}

}  // namespace repose::umat
