#pragma once
/// \file
/// The noise of what frames and pictures show of the six shipped collapses, at their end.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "input/read_scene.hpp"
#include "input/shipped_input.hpp"
#include "mpm/output/rest_pressure.hpp"

namespace repose::study {

constexpr std::array six_scenes{"flat_mcc",   "flat_mu_i",   "flat_newtonian",
                                "tilted_mcc", "tilted_mu_i", "tilted_newtonian"};

/// At most 5 % of what the column above weighs, in the first row on the floor as everywhere, of p
/// and of σ_v; and a picture of the points' own stresses would show at least five times as much, or
/// the scene would say nothing. `sets`: KEY=VALUE, as of --set.
inline void expect_quiet_fields(const std::string& name, const std::vector<std::string>& sets) {
  SCOPED_TRACE(name);
  input::InputFile file = input::open_scene(name, sets);
  mpm::Scene scene = input::read_scene(file).scene;
  mpm::raise_top_to_cells(scene);
  mpm::Simulation simulation(scene, 1);
  while (simulation.time() < scene.end_time) simulation.step(scene.end_time);
  const mpm::RestPressure shown = simulation.rest_pressure(mpm::Stress::averaged);
  const mpm::RestPressure points = simulation.rest_pressure(mpm::Stress::points);
  for (const mpm::Deviation& deviation :
       {shown.pressure, shown.vertical, shown.floor_pressure, shown.floor_vertical})
    EXPECT_LT(deviation.noise, 0.05);
  EXPECT_GT(points.pressure.noise, 5.0 * shown.pressure.noise);
  EXPECT_GT(points.vertical.noise, 5.0 * shown.vertical.noise);
  const auto percent = [](const mpm::RestPressure& rest) {
    return fmt::format("{:.1f} {:.1f} {:.1f} {:.1f}", 100.0 * rest.pressure.noise,
                       100.0 * rest.vertical.noise, 100.0 * rest.floor_pressure.noise,
                       100.0 * rest.floor_vertical.noise);
  };
  fmt::print("{}: noise of p, sigma_v, and both in the first row, % of P: points {}; shown {}\n",
             name, percent(points), percent(shown));
}

}  // namespace repose::study
