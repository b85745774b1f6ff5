#include "mpm/study/failure_modes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

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

/// Draws a block of 1 m out to `most` times its length with a wave speed of `speed` h per unit of
/// time, the rate of stretching being 1. `goes_on` sees the stretch and the error of the density
/// and may end it; returns the stretch at the end.
double draw_out(const Discretisation& d, double speed, double most,
                const std::function<bool(double stretch, double miss)>& goes_on) {
  const double h = 1.0 / d.cells;
  const double c = speed * h;
  const double middle = 0.5 * (most + 1.0);
  // whole cells across, whatever the stretch
  const double width = std::ceil((most + 1.0) / h) * h;
  Scene scene = slippery_box(d, h, width, 1.0, h);
  scene.dt = 0.02;
  scene.bodies = {
      box(std::floor((middle - 0.5) / h) * h, 0.0, 1.0, 1.0, elastic(rho * c * c, 0.0))};
  const double centre = scene.bodies[0].origin[0] + 0.5;
  Prescribed prescribed;
  prescribed.start = [&](double x, double) {
    return PointMotion{{x - centre, 0.0}, {1.0, 0.0, 0.0, 0.0}};
  };
  Simulation simulation(scene, prescribed, 1);
  const std::vector<double> start = simulation.snapshot().x_m;
  double stretch = 1.0;
  try {
    while (stretch < most) {
      simulation.step(HUGE_VAL);
      stretch = 1.0 + simulation.time();
      const auto points = simulation.snapshot();
      double sum = 0.0;
      int count = 0;
      for (std::size_t i = 0; i < start.size(); ++i) {
        if (std::abs(start[i] - centre) > 0.25) continue;
        const double miss = points.density[i] * stretch / rho - 1.0;
        sum += miss * miss;
        ++count;
      }
      const double miss = std::sqrt(sum / count);
      if (!std::isfinite(miss) || !goes_on(stretch, miss)) break;
    }
  } catch (const NumericalFailure&) {
    stretch = 1.0 + simulation.time();
  }
  return std::min(stretch, most);
}

}  // namespace

double cell_crossing_error(const Discretisation& d) {
  double worst = 0.0;
  draw_out(d, 1.0, 1.5, [&](double, double miss) {
    worst = std::max(worst, miss);
    return true;
  });
  return worst;
}

double fracture_stretch(const Discretisation& d) {
  return draw_out(d, 0.01, 8.0, [](double, double miss) { return miss < 0.1; });
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
  return simulation.rest_pressure(Stress::points);
}

}  // namespace repose::mpm
