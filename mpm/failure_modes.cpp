#include "mpm/failure_modes.hpp"

#include <algorithm>
#include <cmath>

namespace repose::mpm {
namespace {

constexpr double rho = 1000.0;

LawSpec elastic(double E, double nu) {
  return {"neo_hookean", {}, {{"E", E}, {"nu", nu}, {"rho_0", rho}}};
}

/// c of the P-wave, c² = E(1 − ν)/(ρ(1 + ν)(1 − 2ν)).
double wave_speed(double E, double nu) {
  return std::sqrt(E * (1.0 - nu) / (rho * (1.0 + nu) * (1.0 - 2.0 * nu)));
}

Scene slippery_box(const Discretisation& d, double h, double width, double height, double c) {
  Scene scene;
  scene.name = "failure";
  scene.gravity = 0.0;
  scene.end_time = 1e9;
  scene.h = h;
  scene.domain = {width, height};
  scene.floor = scene.top = scene.left = scene.right = {Wall::Kind::slip};
  scene.kernel = d.kernel;
  scene.transfer = d.transfer;
  scene.points_per_cell = d.points_per_cell;
  scene.courant = 0.4;
  if (d.transfer == Transfer::relaxed) scene.relaxation_time = 3.0 * h / c;
  return scene;
}

Body box(double x, double y, double width, double height, const LawSpec& law) {
  Body body;
  body.origin = {x, y};
  body.size = {width, height};
  body.law = law;
  return body;
}

}  // namespace

double cell_crossing_error(const Discretisation& d) {
  const double E = 1e5, nu = 0.3, c = wave_speed(E, nu);
  const double h = 1.0 / d.cells;
  Scene scene = slippery_box(d, h, 1.0, 1.0, c);
  scene.left = scene.right = {Wall::Kind::periodic};
  Body body = box(0.0, 0.0, 1.0, 1.0, elastic(E, nu));
  const double p_0 = 1e-3 * E;
  body.initial.p = p_0;
  body.velocity = {0.1 * c, 0.0};
  scene.bodies = {body};
  Simulation simulation(scene, 1);
  const double end = 2.0 * h / (0.1 * c);
  double worst = 0.0;
  while (simulation.time() < end) {
    simulation.step(end);
    double sum = 0.0;
    const auto points = simulation.snapshot();
    for (const double p : points.pressure_Pa) sum += (p / p_0 - 1.0) * (p / p_0 - 1.0);
    worst = std::max(worst, std::sqrt(sum / static_cast<double>(points.pressure_Pa.size())));
  }
  return worst;
}

double fracture_stretch(const Discretisation& d) {
  const double most = 8.0, rate = 1.0;  // 1/s
  const double h = 1.0 / d.cells;
  const double E = rho * 1e-4 * rate * rate * h * h, nu = 0.0;  // c = 0.01 h per strain of one
  const double middle = 0.5 * (most + 1.0);
  Scene scene = slippery_box(d, h, most + 1.0, 1.0, rate * h);
  scene.dt = 0.02 / rate;
  scene.bodies = {box(middle - 0.5, 0.0, 1.0, 1.0, elastic(E, nu))};
  Prescribed prescribed;
  prescribed.start = [&](double x, double) {
    return PointMotion{{rate * (x - middle), 0.0}, {rate, 0.0, 0.0, 0.0}};
  };
  const auto start = Simulation(scene, prescribed, 1).snapshot().x_m;
  Simulation simulation(scene, prescribed, 1);
  try {
    while (1.0 + rate * simulation.time() < most) {
      simulation.step(HUGE_VAL);
      const double stretch = 1.0 + rate * simulation.time();
      const auto points = simulation.snapshot();
      double sum = 0.0;
      int count = 0;
      for (std::size_t i = 0; i < start.size(); ++i) {
        if (std::abs(start[i] - middle) > 0.25) continue;
        const double miss = points.density[i] * stretch / rho - 1.0;
        sum += miss * miss;
        ++count;
      }
      if (!(std::sqrt(sum / count) < 0.1)) return stretch;
    }
  } catch (const NumericalFailure&) {
    return 1.0 + rate * simulation.time();
  }
  return most;
}

double bulge(const Discretisation& d, double nu) {
  const double g = 9.8;
  const double E = 5.0 * rho * g;  // sags by about a tenth of its height of 1 m
  const double h = 1.0 / d.cells;
  Scene scene = slippery_box(d, h, 1.5, 1.5, wave_speed(E, nu));
  scene.gravity = g;
  scene.floor = {Wall::Kind::no_slip};
  scene.bodies = {box(0.0, 0.0, 1.0, 1.0, elastic(E, nu))};
  Simulation simulation(scene, 1);
  // the first swing of the lowest mode, 4H/√(E/ρ), and a little more
  const double end = 2.5 / std::sqrt(E / rho);
  double farthest = 0.0, edge = 0.0;
  for (const double x : simulation.snapshot().x_m) edge = std::max(edge, x);
  constexpr int looks = 100;
  for (int k = 1; k <= looks; ++k) {
    const double stop = end * k / looks;
    while (simulation.time() < stop) simulation.step(stop);
    for (const double x : simulation.snapshot().x_m) farthest = std::max(farthest, x - edge);
  }
  return farthest;
}

RestPressure rest_pressure_after(const Scene& scene) {
  Simulation simulation(scene, 1);
  while (simulation.time() < scene.end_time) simulation.step(scene.end_time);
  return simulation.rest_pressure();
}

}  // namespace repose::mpm
