#include "mpm/study/blow_up.hpp"

#include <cmath>
#include <functional>

#include "mpm/step/simulation.hpp"
#include "mpm/study/noise.hpp"

namespace repose::mpm {
namespace {

constexpr double rho = 1000.0;
constexpr double h = 1.0;
constexpr double wave_speed = 10.0;
constexpr double modulus = rho * wave_speed * wave_speed;  // ρc²
constexpr double poisson = 0.3;
constexpr double noise = 1e-6;
constexpr int cells = 6;

LawSpec fluid(double eta, double K) {
  return {"newtonian",
          {{"tension_cutoff", "false"}},
          {{"eta", eta}, {"K", K}, {"alpha", 1.0}, {"rho_0", rho}}};
}

LawSpec solid() {
  // λ + 2μ = E(1 − ν)/((1 + ν)(1 − 2ν))
  const double E = modulus * (1.0 + poisson) * (1.0 - 2.0 * poisson) / (1.0 - poisson);
  return {"neo_hookean", {}, {{"E", E}, {"nu", poisson}, {"rho_0", rho}}};
}

Scene scene_of(const StepTrial& trial, const LawSpec& law) {
  Scene scene;
  scene.name = "blow_up";
  scene.gravity = 0.0;
  scene.end_time = 1e9;
  scene.domain = {cells * h, cells * h};
  scene.h = h;
  scene.floor = scene.top = {Wall::Kind::slip};
  scene.left = scene.right = {Wall::Kind::slip};
  scene.kernel = trial.kernel;
  scene.transfer = trial.transfer;
  if (trial.transfer == Transfer::relaxed) scene.relaxation_time = 3.0 * h / wave_speed;
  scene.points_per_cell = trial.points_per_cell;
  Body body;
  body.law = law;
  body.origin = {0.0, 0.0};
  body.size = {cells * h, cells * h};
  if (trial.place == Place::surface) body.size[1] = 0.5 * cells * h;
  if (trial.place == Place::isolated) {
    scene.points_per_cell = 1;
    body.size = {h, h};
    body.origin = {(2.5 + trial.offset) * h, (2.5 + trial.offset) * h};
  }
  body.initial.p = noise * modulus;
  scene.bodies = {body};
  return scene;
}

/// Whether noise stays within a thousand times its size over 600 steps.
bool stays(Scene scene, double dt) {
  scene.dt = dt;
  Prescribed prescribed;
  prescribed.start = [](double x, double y) {
    PointMotion motion;
    for (std::size_t k = 0; k < 2; ++k)
      motion.velocity[k] = noise * wave_speed * scatter(x, y, static_cast<double>(k));
    for (std::size_t k = 0; k < 4; ++k)
      motion.gradient[k] = noise * wave_speed / h * scatter(x, y, 2.0 + static_cast<double>(k));
    return motion;
  };
  const auto size = [](const Simulation& simulation) {
    const Simulation::Snapshot s = simulation.snapshot();
    double most = 0.0;
    for (const std::vector<double>* field : {&s.sxx, &s.syy, &s.sxy})
      for (const double x : *field)
        most = std::isfinite(x) ? std::max(most, std::abs(x)) : HUGE_VAL;
    return most;
  };
  try {
    Simulation simulation(scene, prescribed, 1);
    double start = size(simulation);
    for (int n = 0; n < 600; ++n) {
      simulation.step(HUGE_VAL);
      if (n < 5) start = std::max(start, size(simulation));
      if (n % 20 == 19 && !(size(simulation) < 1e3 * start)) return false;
    }
    return true;
  } catch (const NumericalFailure&) {
    return false;
  }
}

/// The largest x in (low, high) of which `is_stable`, to 1 %: first up from low by half octaves.
double bisect(double low, const std::function<bool(double)>& is_stable) {
  if (!is_stable(low)) return 0.0;
  double high = low;
  for (int k = 0; k < 16; ++k) {
    high *= std::sqrt(2.0);
    if (!is_stable(high)) break;
    low = high;
  }
  while (high / low > 1.01) {
    const double middle = std::sqrt(low * high);
    (is_stable(middle) ? low : high) = middle;
  }
  return low;
}

/// A fluid whose sound does not limit the step: c Δt/h = 0.02 at the viscous limit.
Scene viscous_scene(const StepTrial& trial, double& unit) {
  const double eta = rho * h * wave_speed / 0.08;
  unit = rho * h * h / (4.0 * eta);  // c·unit/h = 0.02
  return scene_of(trial, fluid(eta, modulus));
}

}  // namespace

double blow_up_courant(const StepTrial& trial) {
  const Scene scene = scene_of(trial, trial.solid ? solid() : fluid(0.0, modulus));
  return bisect(0.1, [&](double courant) { return stays(scene, courant * h / wave_speed); });
}

double courant_of_theory(const StepTrial& trial) {
  const bool cubic = trial.kernel == Kernel::cubic;
  if (trial.place == Place::surface) return std::nan("");
  if (trial.place == Place::bulk) return (cubic ? 1.93 : 1.63) / std::sqrt(2.0);
  // ω² = E/(ρD), E the larger of 2(λ + μ) and 2μ; M = λ + 2μ, λ/M = ν/(1 − ν)
  const double lambda = trial.solid ? poisson / (1.0 - poisson) : 1.0;
  const double mu = 0.5 * (1.0 - lambda);
  const double moment = cubic ? 1.0 / 3.0 : 0.25;
  return 2.0 * std::sqrt(moment / (2.0 * (lambda + mu)));
}

double blow_up_viscous(const StepTrial& trial) {
  double unit = 0.0;
  const Scene scene = viscous_scene(trial, unit);
  return bisect(0.1, [&](double times) { return stays(scene, times * unit); });
}

bool implicit_viscosity_is_stable(const StepTrial& trial, double times) {
  double unit = 0.0;
  Scene scene = viscous_scene(trial, unit);
  scene.viscosity = Viscosity::implicit_solve;
  return stays(scene, times * unit);
}

}  // namespace repose::mpm
