/// \file
/// Stress updates per second on one core, for every law: LawMaterial::update over a batch that fits
/// the second-level cache, and modified Cam-Clay one point at a time.
///
/// Each pass starts from the same points (restored outside the timed region), so that "elastic" and
/// "plastic" stay what they say. Steps are those of a collapse: strains of about 1e-4.

#include <random>

#include <benchmark/benchmark.h>

#include "models/all_laws.hpp"
#include "models/law_material.hpp"
#include "models/registry.hpp"

namespace repose {
namespace {

constexpr std::size_t count = 2048;
using Column = std::vector<double>;

/// Points with their increments, and a copy of what update() overwrites.
struct Points {
  std::array<Column, 4> strain, stress, state;
  Column spin, density;

  Points() {
    for (auto* columns : {&strain, &stress, &state})
      for (Column& column : *columns) column.resize(count);
    spin.resize(count);
    density.resize(count);
  }
  Batch batch(double dt, std::size_t states) {
    Batch b;
    b.count = count;
    b.dt = dt;
    for (std::size_t k = 0; k < 4; ++k) {
      b.strain[k] = strain[k].data();
      b.stress[k] = stress[k].data();
      if (k < states) b.state[k] = state[k].data();
    }
    b.spin = {spin.data()};
    b.density = density.data();
    return b;
  }
};

enum class Lanes : std::uint8_t { elastic, plastic, mixed };

LawSpec spec_of(const LawInfo& law) {
  LawSpec spec{std::string(law.name), {}, {}};
  if (!law.option_key.empty()) spec.options[std::string(law.option_key)] = law.option;
  if (law.name == "modified_cam_clay")
    spec.values = {{"M", 0.6614},  {"lambda", 0.0186},     {"kappa", 0.001}, {"nu", 0.3},
                   {"p_ref", 1.0}, {"Gamma", 1.0 / 0.648}, {"rho_p", 2000.0}};
  if (law.name == "mu_i")
    spec.values = {{"mu_0", 0.3819},  {"mu_d", 0.5718},  {"I_0", 0.279}, {"d", 0.0053},
                   {"rho_p", 2000.0}, {"rho_0", 1300.0}, {"K", 254800.0}};
  if (law.name == "newtonian") spec.values = {{"eta", 0.002}, {"K", 26000.0}, {"rho_0", 1300.0}};
  return spec;
}

/// Random stresses at p = 1 kPa (Cam-Clay: on the yield surface from wet to dry, or well inside it)
/// with random strains of size 1e-4 that point out of the surface or not.
Points random_points(const LawInfo& law, const Material& material, Lanes lanes) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Points points;
  const bool cam_clay = law.name == "modified_cam_clay";
  const double p = 1000.0;
  for (std::size_t i = 0; i < count; ++i) {
    std::array<double, 4> direction{uniform(random), uniform(random), uniform(random),
                                    uniform(random)};
    const double mean = (direction[0] + direction[1] + direction[2]) / 3.0;
    for (std::size_t k = 0; k < 3; ++k) direction[k] -= mean;
    double norm = direction[3] * direction[3];
    for (const double x : direction) norm += x * x;
    norm = std::sqrt(norm);  // s:s = 1
    const bool plastic = lanes == Lanes::plastic || (lanes == Lanes::mixed && i % 2 == 0);
    double q = 0.0;
    if (cam_clay) {
      const double x = 0.55 + 0.35 * uniform(random);  // p/p_c
      const double M = material.parameter("M");
      q = M * p * std::sqrt((1.0 - x) / x) * (plastic ? 1.0 : 0.5);
      points.state[0][i] = p / x;
      points.density[i] = material.density_at(p, 1.0 / x);
    } else {
      q = law.has_stress_memory ? std::sqrt(3.0) * 0.3819 * p * (plastic ? 1.0 : 0.5) : 0.0;
      points.density[i] = material.density_at(p, 1.0);
    }
    const double s = q * std::sqrt(2.0 / 3.0) / norm;
    for (std::size_t k = 0; k < 4; ++k) {
      points.stress[k][i] = s * direction[k] - (k < 3 ? p : 0.0);
      // along the deviator: outwards; plus something of every direction
      const double outwards = (plastic ? 1.0 : -0.3) * 1e-4 * direction[k] / norm;
      points.strain[k][i] = outwards + (cam_clay ? 2e-6 : 2e-5) * uniform(random);
    }
    points.spin[i] = 1e-4 * uniform(random);
  }
  return points;
}

void batch_update(benchmark::State& timing, const LawInfo* law, Lanes lanes) {
  const auto material = make_material(spec_of(*law));
  const Points start = random_points(*law, *material, lanes);
  Points points = start;
  for (auto _ : timing) {
    timing.PauseTiming();
    points = start;
    const Batch batch = points.batch(1e-4, law->state.size());
    timing.ResumeTiming();
    const UpdateReport report = material->update(batch);
    if (!report.ok()) timing.SkipWithError("a point failed");
    benchmark::ClobberMemory();
  }
  timing.counters["updates/s"] =
      benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate);
}

template <Compression compression>
void one_at_a_time(benchmark::State& timing, Lanes lanes) {
  using Law = ModifiedCamClay<compression>;
  const LawInfo& law = LawMaterial<Law>::info();
  const auto material = make_material(spec_of(law));
  const auto P = Law::template Params<double>::from(material->theta());
  const Points points = random_points(law, *material, lanes);
  std::size_t i = 0;
  for (auto _ : timing) {
    Increment<double, 4> inc;
    Sym<double, 4> stress;
    for (std::size_t k = 0; k < 4; ++k) {
      inc.strain.c[k] = points.strain[k][i];
      stress.c[k] = points.stress[k][i];
    }
    inc.dt = 1e-4;
    inc.density = points.density[i];
    typename Law::template State<double> state{points.state[0][i], points.state[1][i]};
    const bool failed = Law::update(P, inc, stress, state);
    benchmark::DoNotOptimize(failed);
    benchmark::DoNotOptimize(stress);
    benchmark::DoNotOptimize(state);
    i = i + 1 < count ? i + 1 : 0;
  }
  timing.counters["updates/s"] =
      benchmark::Counter(1.0, benchmark::Counter::kIsIterationInvariantRate);
}

const char* to_text(Lanes lanes) {
  if (lanes == Lanes::elastic) return "elastic";
  return lanes == Lanes::plastic ? "plastic" : "mixed";
}

const bool registered = [] {
  for (const LawInfo& law : library_laws()) {
    const std::string base = "batch/" + std::string(law.name) + "/" + std::string(law.option);
    if (!law.has_stress_memory) {
      benchmark::RegisterBenchmark(base.c_str(), batch_update, &law, Lanes::plastic);
      continue;
    }
    for (const Lanes lanes : {Lanes::elastic, Lanes::plastic, Lanes::mixed})
      benchmark::RegisterBenchmark((base + "/" + to_text(lanes)).c_str(), batch_update, &law,
                                   lanes);
  }
  for (const Lanes lanes : {Lanes::elastic, Lanes::plastic}) {
    benchmark::RegisterBenchmark(
        (std::string("one/modified_cam_clay/ln_v-ln_p/") + to_text(lanes)).c_str(),
        one_at_a_time<Compression::ln_v_ln_p>, lanes);
    benchmark::RegisterBenchmark(
        (std::string("one/modified_cam_clay/v-ln_p/") + to_text(lanes)).c_str(),
        one_at_a_time<Compression::v_ln_p>, lanes);
  }
  return true;
}();

}  // namespace
}  // namespace repose
