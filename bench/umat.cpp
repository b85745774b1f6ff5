/// \file
/// Calls of the UMAT per second on one core, with its tangent, against the same points' updates by
/// LawMaterial (a batch at a time, as the Material Point Method has them) and by the law in plain
/// numbers, one point at a time. Steps of strains of about 1e-4 from points with a history, elastic
/// and plastic ones as they come; every pass starts from the same points.

#include <random>

#include <benchmark/benchmark.h>

#include "models/all_laws.hpp"
#include "models/law_material.hpp"
#include "models/registry.hpp"
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

namespace repose {
namespace {

constexpr std::size_t count = 2048;
constexpr double dt = 1e-4;

template <class L>
LawSpec spec_of() {
  LawSpec spec{std::string(L::name), {}, {}};
  if (!L::option_key.empty()) spec.options[std::string(L::option_key)] = L::option;
  if (L::name == "mu_i")
    spec.values = {{"mu_0", 0.3819},  {"mu_d", 0.5718},  {"I_0", 0.279}, {"d", 0.0053},
                   {"rho_p", 2000.0}, {"rho_0", 1300.0}, {"K", 254800.0}};
  else
    spec.values = {{"M", 0.6614},  {"lambda", 0.0186},     {"kappa", 0.001}, {"nu", 0.3},
                   {"p_ref", 1.0}, {"Gamma", 1.0 / 0.648}, {"rho_p", 2000.0}};
  if (L::name == "critical_state_mu_i")
    spec.values.insert({{"d", 0.0053}, {"I_v", 0.5}, {"M_inf", 0.9904}, {"I_M", 0.1611}});
  return spec;
}

/// A point before its step, and the step's strain.
template <class L, int N>
struct Start {
  Sym<double, N> stress, strain;
  typename L::template State<double> state{};
  double density = 0.0;
};

template <class L, int N>
std::vector<Start<L, N>> starts() {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const std::vector<double> theta = checked_parameters(spec_of<L>());
  const auto P = L::template Params<double>::from(theta);
  const auto strain_of = [&](double size) {
    Sym<double, N> strain;
    for (int k = 0; k < N; ++k) strain[k] = size * uniform(random);
    return strain;
  };
  std::vector<Start<L, N>> points;
  while (points.size() < count) {
    InitialConditions given;
    given.p = 1e3;
    if (L::state.size() > 0) given.ocr = 1.5 + 0.5 * uniform(random);
    const InitialPoint at_rest = L::initial(P, given);
    Start<L, N> point;
    for (int k = 0; k < N; ++k) point.stress[k] = at_rest.stress[k];
    for (std::size_t k = 0; k < L::state.size(); ++k) point.state[k] = at_rest.state[k];
    point.density = at_rest.density;
    bool usable = true;
    for (int step = 0; step < 6 && usable; ++step) {
      const Sym<double, N> strain = strain_of(3e-4);
      const double density = point.density * std::exp(-trace(strain));
      usable = !L::update(P, {strain, dt, density}, point.stress, point.state);
      point.density = density;
    }
    if (!usable || !(pressure(point.stress) > 100.0)) continue;
    point.strain = strain_of(1e-4);
    points.push_back(point);
  }
  return points;
}

void report(benchmark::State& timing) {
  timing.counters["points/s"] =
      benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate);
}

template <class L, int N>
void by_umat(benchmark::State& timing) {
  const auto from = starts<L, N>();
  const LawSpec spec = spec_of<L>();
  std::vector<double> props;
  for (const ParamInfo& parameter : find_law(spec).parameters) {
    const auto given = spec.values.find(std::string(parameter.name));
    props.push_back(given == spec.values.end() ? 0.0 : given->second);
  }
  std::string name = umat::material_name(find_law(spec));
  name.resize(80, ' ');
  constexpr auto n = static_cast<std::size_t>(N);
  constexpr std::size_t states = 1 + L::state.size();
  std::vector<std::array<double, n>> stress(count), strain(count);
  std::vector<std::array<double, states>> statev(count);
  const auto at = [](int i) { return N == 6 && i > 3 ? 9 - i : i; };
  std::array<double, n * n> ddsdde;
  const std::array<double, 36> zeros{};
  std::array<double, 36> unused{};
  double* const u = unused.data();
  const double* const z = zeros.data();
  const int ndi = 3, nshr = N - 3, ntens = N, nstatv = states, one = 1;
  const int nprops = static_cast<int>(props.size());
  for (auto _ : timing) {
    timing.PauseTiming();
    for (std::size_t p = 0; p < count; ++p) {
      for (int i = 0; i < N; ++i) {
        stress[p][static_cast<std::size_t>(i)] = from[p].stress[at(i)];
        strain[p][static_cast<std::size_t>(i)] = (i < 3 ? 1.0 : 2.0) * from[p].strain[at(i)];
      }
      statev[p][0] = from[p].density;
      for (std::size_t k = 1; k < states; ++k) statev[p][k] = from[p].state[k - 1];
    }
    timing.ResumeTiming();
    for (std::size_t p = 0; p < count; ++p) {
      double sse = 0.0, spd = 0.0, scd = 0.0, pnewdt = 1e10;
      umat_(stress[p].data(), statev[p].data(), ddsdde.data(), &sse, &spd, &scd, u, u, u, u, z,
            strain[p].data(), z, &dt, z, z, z, z, name.data(), &ndi, &nshr, &ntens, &nstatv,
            props.data(), &nprops, z, z, &pnewdt, z, z, z, &one, &one, &one, &one, &one, &one,
            name.size());
      if (pnewdt < 1.0) timing.SkipWithError("a step failed");
      benchmark::DoNotOptimize(ddsdde);
    }
  }
  report(timing);
}

template <class L, int N>
void by_plain_update(benchmark::State& timing) {
  const auto from = starts<L, N>();
  const std::vector<double> theta = checked_parameters(spec_of<L>());
  const auto P = L::template Params<double>::from(theta);
  auto points = from;
  for (auto _ : timing) {
    timing.PauseTiming();
    points = from;
    timing.ResumeTiming();
    for (Start<L, N>& point : points) {
      point.density *= exp_pair(-trace(point.strain)).whole;
      StepWork<double> spent;
      if (L::update(P, {point.strain, dt, point.density}, point.stress, point.state, &spent))
        timing.SkipWithError("a step failed");
      benchmark::DoNotOptimize(spent);
    }
    benchmark::ClobberMemory();
  }
  report(timing);
}

template <class L, int N>
void by_batch(benchmark::State& timing) {
  const auto from = starts<L, N>();
  const auto material = make_material(spec_of<L>());
  constexpr auto n = static_cast<std::size_t>(N);
  std::array<std::vector<double>, n> stress, strain;
  std::array<std::vector<double>, 4> state;
  std::vector<double> density(count);
  BatchOf<N> batch;
  batch.count = count;
  batch.dt = dt;
  for (std::size_t k = 0; k < n; ++k) {
    stress[k].resize(count);
    strain[k].resize(count);
    batch.stress[k] = stress[k].data();
    batch.strain[k] = strain[k].data();
  }
  for (std::size_t k = 0; k < L::state.size(); ++k) {
    state[k].resize(count);
    batch.state[k] = state[k].data();
  }
  batch.density = density.data();
  for (auto _ : timing) {
    timing.PauseTiming();
    for (std::size_t p = 0; p < count; ++p) {
      for (std::size_t k = 0; k < n; ++k) {
        stress[k][p] = from[p].stress.c[k];
        strain[k][p] = from[p].strain.c[k];
      }
      for (std::size_t k = 0; k < L::state.size(); ++k) state[k][p] = from[p].state[k];
      density[p] = from[p].density;
    }
    timing.ResumeTiming();
    if (!material->update(batch).ok()) timing.SkipWithError("a step failed");
    benchmark::ClobberMemory();
  }
  report(timing);
}

template <class L, int N>
void add(const std::string& name) {
  const std::string in = N == 4 ? "/plane" : "/space";
  benchmark::RegisterBenchmark((name + "/umat" + in).c_str(), by_umat<L, N>);
  benchmark::RegisterBenchmark((name + "/update" + in).c_str(), by_plain_update<L, N>);
  benchmark::RegisterBenchmark((name + "/batch" + in).c_str(), by_batch<L, N>);
}

const int registered = [] {
  using Clay = ModifiedCamClay<Compression::ln_v_ln_p>;
  add<Clay, 4>("modified_cam_clay");
  add<Clay, 6>("modified_cam_clay");
  add<MuIElastoviscoplastic, 4>("mu_i");
  add<MuIElastoviscoplastic, 6>("mu_i");
  add<CriticalStateMuI, 4>("critical_state_mu_i");
  add<CriticalStateMuI, 6>("critical_state_mu_i");
  return 0;
}();

}  // namespace
}  // namespace repose
