// A column of grains collapses on a flat floor, by the Material Point Method, until it rests: a
// coarse and short version of data/scenes/flat_mu_i.toml, set up in memory. SI units, per metre of
// depth.
#include <cmath>
#include <cstdio>

#include <repose/mpm/output/rest_pressure.hpp>
#include <repose/mpm/step/simulation.hpp>

using namespace repose;

int main() {
  mpm::Scene scene;
  scene.name = "column";
  scene.domain = {1.2, 0.5, 0.0};  // no extent along z: plane strain
  scene.floor.kind = mpm::Wall::Kind::no_slip;
  scene.h = 0.0125;  // cells of a box that they divide; four points in each
  scene.end_time = 0.6;

  mpm::Body column;
  column.name = "column";
  column.origin = {0.0, 0.0, 0.0};
  column.size = {0.2, 0.4, 0.0};
  column.law = {"mu_i",
                {},
                {{"mu_0", 0.3819},
                 {"mu_d", 0.5718},
                 {"I_0", 0.279},
                 {"d", 0.0053},
                 {"rho_p", 2000.0},
                 {"rho_0", 1300.0},
                 {"K", 254800.0}}};
  scene.bodies = {column};

  // The constructor checks the scene, lays the points and throws InputError, with the key of a
  // scene file, for what makes none. Results are the same bits for any number of threads.
  mpm::Simulation simulation(scene);
  const double mass = simulation.diagnostics().mass_kg_per_m;
  std::printf("%lld points, %.1f kg/m\n", static_cast<long long>(simulation.point_count()), mass);

  std::puts("t [s]   front [m]   kinetic energy [J/m]");
  for (int row = 1; row <= 6; ++row) {
    const double until = row * scene.end_time / 6;
    while (simulation.time() < until) simulation.step(until);  // lands exactly on `until`
    const mpm::SeriesRow now = simulation.diagnostics();
    std::printf("%5.2f %11.4f %22.3f\n", now.time_s, now.front_99_m, now.kinetic_J_per_m);
  }

  // Every form of energy is measured by itself, so what does not add up shows.
  const mpm::SeriesRow end = simulation.diagnostics();
  const double start = 0.5 * mass * scene.gravity * column.size[1];  // of the column's height
  std::printf("of %.1f J/m: dissipated %.1f, not accounted for %.2g\n", start,
              end.dissipated_J_per_m, end.energy_residual_J_per_m);
  const auto profile = simulation.profile();
  std::printf("the heap is %.3f m high at the wall and %.3f m half a metre from it\n", end.height_m,
              profile.depth_m[static_cast<std::size_t>(0.5 / scene.h)]);
  const bool sound = std::abs(end.energy_residual_J_per_m) < 0.01 * start &&
                     std::abs(end.mass_kg_per_m / mass - 1.0) < 1e-12;
  return sound && end.front_99_m > 0.5 && end.front_99_m < 1.2 ? 0 : 1;
}
