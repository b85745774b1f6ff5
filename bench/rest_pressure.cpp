/// The figures of docs/noise.md: pressure against overburden where a scene has come to rest.
///
///   bench_rest_pressure SCENE LAW H TRANSFER COURANT AVERAGING [END_TIME]
///
/// SCENE collapse | column (16 cells wide, on a no-slip floor); LAW mu_i | mu_i_soft | cam_clay |
/// newtonian; H cell size [m]; TRANSFER and AVERAGING as step.transfer and step.pressure_averaging.

#include "mpm/output/rest_pressure.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include <fmt/core.h>

#include "tests/mpm/scenes.hpp"

namespace {

using namespace repose::mpm;

repose::LawSpec law_named(const std::string& name) {
  if (name == "mu_i") return mu_i();
  if (name == "mu_i_soft") return mu_i(26000.0);
  if (name == "cam_clay") return cam_clay();
  if (name == "newtonian") return newtonian(0.8, 254800.0, 1.0, 1300.0);
  throw std::invalid_argument("no law " + name);
}

Scene scene_named(const std::string& name, const repose::LawSpec& law, double h) {
  if (name == "collapse") return column_collapse(law, h);
  if (name != "column") throw std::invalid_argument("no scene " + name);
  Scene scene = empty_box(16 * h, 0.6, h);
  scene.gravity = 9.8;
  scene.floor = {Wall::Kind::no_slip};
  scene.bodies = {block(0.0, 0.0, 16 * h, 0.4, law)};
  return scene;
}

void print(const char* name, const Deviation& d) {
  fmt::print("  {} {:.3f} (smooth {:.3f}, noise {:.4f})", name, d.total, d.smooth, d.noise);
}

int run(const std::vector<std::string>& arguments) {
  Scene scene =
      scene_named(arguments.at(0), law_named(arguments.at(1)), std::stod(arguments.at(2)));
  const auto transfer = std::find(transfer_names.begin(), transfer_names.end(), arguments.at(3));
  if (transfer == transfer_names.end()) throw std::invalid_argument("no such transfer");
  scene.transfer = static_cast<Transfer>(transfer - transfer_names.begin());
  scene.courant = std::stod(arguments.at(4));
  scene.pressure_averaging = std::stod(arguments.at(5));
  const double end = arguments.size() > 6 ? std::stod(arguments[6]) : 1.2;

  Simulation simulation(scene, 1);
  const auto begun = std::chrono::steady_clock::now();
  run_until(simulation, end);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun;
  const SeriesRow row = simulation.diagnostics();
  const RestPressure rest = simulation.rest_pressure(Stress::points);
  const Simulation::Snapshot points = simulation.snapshot();
  std::vector<double> x = points.x_m;
  std::sort(x.begin(), x.end());
  double volume = 0.0;
  for (const double rho : points.density) volume += 1.0 / rho;
  const auto n = static_cast<double>(x.size());
  const auto share = [&](double part) { return x[static_cast<std::size_t>(part * (n - 1.0))]; };
  for (const std::string& a : arguments) fmt::print("{} ", a);
  fmt::print("\n ");
  print("p", rest.pressure);
  print("sigma_v", rest.vertical);
  print("of the largest overburden: p", rest.pressure_of_largest);
  print("sigma_v", rest.vertical_of_largest);
  fmt::print("\n    p/P {:.3f} sigma_v/P {:.3f}, first row {:.3f} {:.3f}, P_max {:.0f} Pa\n",
             rest.mean_ratio, rest.mean_vertical_ratio, rest.floor_ratio, rest.floor_vertical_ratio,
             rest.largest_overburden);
  fmt::print(
      "    median x {:.4f}, 90 % {:.4f}, 99 % {:.4f}, front {:.4f}, height {:.4f} m; kinetic "
      "{:.1e} "
      "J/m, residual {:.1e}; mean rho_0/rho {:.5f}; {} steps, {:.1f} ns per point-step\n",
      share(0.5), share(0.9), share(0.99), row.front_m, row.height_m, row.kinetic_J_per_m,
      row.energy_residual_J_per_m, 1300.0 * volume / n, row.step,
      1e9 * spent.count() / static_cast<double>(simulation.point_steps()));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_rest_pressure: {}\n", error.what());
    return 2;
  }
}
