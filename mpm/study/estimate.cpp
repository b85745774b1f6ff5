#include "mpm/study/estimate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/core.h>

#include "mpm/step/simulation_impl.hpp"
#include "mpm/study/needs.hpp"

namespace repose::mpm {
namespace {

/// Wave speed of a law at rest under pressure p; 0 if it has no rest state there [m/s].
double wave_speed_under(const Material& material, double p) {
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
    std::array<double, pack_size> modulus{};
    material.modulus(one.batch({0, 1}), modulus.data());
    return std::sqrt(modulus[0] / at.density);
  } catch (const InputError&) {
    return 0.0;  // for instance Cam-Clay whose line is not known: the step is then that of the
                 // start
  }
}

/// Step that the fastest signal on the way allows: free fall through the height of the scene, and
/// the stiffness under twice the weight of the highest body (what an impact from rest brings).
/// density: of a body at the start.
template <class Density>
double wave_step(const Scene& scene, const Density& density) {
  double top = 0.0;
  double signal = 0.0;
  for (const Body& body : scene.bodies) top = std::max(top, body.origin[1] + body.size[1]);
  for (const Body& body : scene.bodies) {
    const auto material = make_material(body.law);
    const double weight = density(*material, body) * scene.gravity * body.size[1];
    signal = std::max(signal, wave_speed_under(*material, 2.0 * weight) +
                                  std::hypot(body.velocity[0], body.velocity[1]));
  }
  signal += std::sqrt(2.0 * scene.gravity * top);
  return signal > 0.0 ? scene.courant * scene.h / signal : scene.end_time;
}

/// More points than this are not laid out for an estimate: that would take seconds, and gigabytes.
constexpr double most_points_measured = 1e6;
/// Of a point in a step, on one core; the shipped scenes take 0.6 to 1.1e-7.
constexpr double seconds_per_point_step = 1e-7;

/// From the numbers of the scene alone.
Estimate counted(const Scene& scene, const Needs& needs) {
  Estimate e;
  e.points = std::llround(needs.points);
  e.live_cells = std::llround(needs.points / scene.points_per_cell);
  e.memory_MB = needs.memory_MB;
  e.first_dt_s =
      scene.dt ? *scene.dt : wave_step(scene, [](const Material& material, const Body& body) {
        return body.lithostatic ? material.density_at(0.0, body.initial.ocr.value_or(1.0))
                                : material.initial(body.initial).density;
      });
  require_end_in_reach(scene, e.first_dt_s);
  e.steps = scene.end_time / e.first_dt_s;
  e.seconds = needs.points * e.steps * seconds_per_point_step;
  e.warnings.push_back(
      "steps and time are counted, not measured: so many points are not laid out for an estimate, "
      "and a viscosity may take shorter steps");
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
  Simulation simulation(scene, threads);
  e.points = simulation.point_count();
  e.live_cells = simulation.live_cells();
  e.first_dt_s = simulation.next_dt();
  require_end_in_reach(scene, e.first_dt_s);
  const double typical =
      scene.dt ? *scene.dt
               : std::min(e.first_dt_s, wave_step(scene, [&](const Material&, const Body&) {
                            return simulation.diagnostics().density_max;
                          }));
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
  e.memory_MB = simulation.counters().memory_MB;
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
