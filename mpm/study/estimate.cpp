#include "mpm/study/estimate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/core.h>

#include "mpm/scene/restitution.hpp"
#include "mpm/step/simulation_impl.hpp"
#include "mpm/study/needs.hpp"

namespace repose::mpm {
namespace {

/// A law at rest under pressure p: what limits an explicit step.
struct AtRest {
  double wave_speed = 0.0;   ///< 0 if it has no rest state there [m/s]
  double diffusivity = 0.0;  ///< η/ρ of an explicit viscosity [m²/s]
};
AtRest at_rest_under(const Material& material, double p) {
  InitialConditions given;
  given.p = p;
  given.ocr = 1.0;
  if (std::none_of(material.law().state.begin(), material.law().state.end(),
                   [](const StateField& f) { return f.name == "p_c"; }))
    given.ocr.reset();
  given.density.reset();
  try {
    const InitialPoint at = material.initial(given);
    PointSet one;
    for (std::size_t f = 0; f < one.field.size(); ++f) one.field[f].assign(pack_size, 1.0);
    for (int k = 0; k < 4; ++k)
      one.field[SXX + static_cast<std::size_t>(k)].assign(pack_size, at.stress[k]);
    one.field[RHO].assign(pack_size, at.density);
    for (std::size_t k = 0; k < at.state.size(); ++k)
      one.field[STATE + k].assign(pack_size, at.state[k]);
    one.fields = STATE + at.state.size();
    std::array<double, pack_size> modulus{}, viscosity{}, thinning{};
    Batch batch = one.batch({0, 1});
    material.modulus(batch, modulus.data());
    AtRest rest{std::sqrt(modulus[0] / at.density), 0.0};
    if (!material.law().has_stress_memory) {
      const std::array<double, pack_size> no_strain{};
      batch.strain.fill(no_strain.data());
      batch.dt = 1.0;
      material.viscosity(batch, viscosity.data(), thinning.data());
      rest.diffusivity = viscosity[0] / at.density;
    }
    return rest;
  } catch (const InputError&) {
    return {};  // for instance Cam-Clay whose line is not known: the step is then that of the start
  }
}

/// What limits the explicit steps on the way.
struct StepLimits {
  double wave_s = HUGE_VAL;     ///< the fastest signal
  double viscous_s = HUGE_VAL;  ///< the largest viscosity
};

/// By free fall through the height of the scene, and stiffness and viscosity under twice the weight
/// of the highest body (what an impact from rest brings). density: of a body at the start.
template <class Density>
StepLimits limits_on_the_way(const Scene& scene, const Density& density) {
  double top = 0.0;
  double signal = 0.0, diffusivity = 0.0;
  for (const Body& body : scene.bodies) top = std::max(top, body.origin[1] + body.size[1]);
  for (const Body& body : scene.bodies) {
    const auto material = make_material(body.law);
    const double weight = density(*material, body) * scene.gravity * body.size[1];
    const AtRest rest = at_rest_under(*material, 2.0 * weight);
    const double damped =
        body.restitution
            ? damped_signal(damping_length(*body.restitution, material->parameter("d")), scene.h)
            : 1.0;
    signal =
        std::max(signal, damped * rest.wave_speed + std::hypot(body.velocity[0], body.velocity[1]));
    diffusivity = std::max(diffusivity, rest.diffusivity);
  }
  signal += std::sqrt(2.0 * scene.gravity * top);
  StepLimits limits;
  if (signal > 0.0) limits.wave_s = scene.courant * scene.h / signal;
  if (diffusivity > 0.0 && scene.viscosity == Viscosity::explicit_force)
    limits.viscous_s = stable_step(
        {0.0, 0.0,
         2.0 * static_cast<double>(scene.dimensions()) * diffusivity / (scene.h * scene.h)},
        scene.courant, scene.h);
  return limits;
}

/// More points than this are not laid out for an estimate: that would take seconds, and gigabytes.
constexpr double most_points_measured = 1e6;
/// Of a point in a step, on one core; the shipped scenes take 0.6 to 1.1e-7.
constexpr double seconds_per_point_step = 1e-7;

/// From the numbers of the scene alone.
Estimate counted(const Scene& scene, const Needs& needs) {
  Estimate e;
  e.points = std::llround(needs.points);
  for (const Body& body : scene.bodies) e.volume += volume_of(scene, body);
  e.live_cells = std::llround(needs.points / scene.points_per_cell);
  e.memory_MB = needs.memory_MB;
  const StepLimits limits =
      limits_on_the_way(scene, [](const Material& material, const Body& body) {
        return body.lithostatic ? material.density_at(0.0, body.initial.ocr.value_or(1.0))
                                : material.initial(body.initial).density;
      });
  e.wave_dt_s = std::min(limits.wave_s, scene.end_time);
  e.viscous_dt_s = limits.viscous_s;
  e.first_dt_s = scene.dt ? *scene.dt : std::min(e.wave_dt_s, e.viscous_dt_s);
  require_end_in_reach(scene, e.first_dt_s);
  e.steps = scene.end_time / e.first_dt_s;
  e.seconds = needs.points * e.steps * seconds_per_point_step;
  e.warnings.push_back(
      "steps and time are counted, not measured: so many points are not laid out for an estimate");
  return e;
}

}  // namespace

Estimate count_estimate(const Scene& scene) {
  validate(scene);
  require_memory(scene);
  return counted(scene, needs_of(scene));
}

Estimate estimate(const Scene& scene, int threads) {
  validate(scene);
  const Needs needs = needs_of(scene);
  require_memory(scene);
  if (needs.points > most_points_measured || needs.box_cells > 100.0 * most_points_measured)
    return counted(scene, needs);
  Estimate e;
  e.measured = true;
  Simulation simulation(scene, threads);
  e.points = simulation.point_count();
  const Simulation::Snapshot start_points = simulation.snapshot();
  for (std::size_t n = 0; n < start_points.mass.size(); ++n)
    e.volume += start_points.mass[n] / start_points.density[n];
  e.live_cells = simulation.live_cells();
  e.first_dt_s = simulation.next_dt();
  require_end_in_reach(scene, e.first_dt_s);
  const StepLimits limits = limits_on_the_way(
      scene, [&](const Material&, const Body&) { return simulation.diagnostics().density_max; });
  e.wave_dt_s = std::min(e.first_dt_s, limits.wave_s);
  e.viscous_dt_s = limits.viscous_s;
  const double typical = scene.dt ? *scene.dt : std::min(e.wave_dt_s, e.viscous_dt_s);
  e.steps = scene.end_time / typical;

  // a few real steps, for at most half a second
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const double horizon = 1e3 * e.first_dt_s;
  int steps = 0;
  try {
    while (steps < 20 && elapsed() < 0.5) {
      simulation.step(horizon);
      ++steps;
    }
  } catch (const NumericalFailure& failure) {
    e.warnings.push_back(fmt::format("the first steps fail: {}", failure.what()));
  }
  if (steps > 0) e.seconds = elapsed() / steps * e.steps;
  e.memory_MB = simulation.counters().memory_MB + needs.grid_frames_MB;
  for (const std::string& warning : simulation.warnings()) e.warnings.push_back(warning);
  if (!scene.dt && e.steps > 1e7)
    e.warnings.push_back(fmt::format(
        "the stable step of {:.3g} s means {:.3g} steps: a large bulk modulus over the density, "
        "small "
        "cells or an explicit viscosity make it short (step.viscosity = \"implicit\" and form = "
        "\"elastoviscoplastic\" have no limit by viscosity)",
        typical, e.steps));
  return e;
}

}  // namespace repose::mpm
