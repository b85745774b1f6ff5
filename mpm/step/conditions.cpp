/// What may change while a simulation goes on: gravity and the walls.

#include <fmt/format.h>

#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {
namespace {

struct Edge {
  std::string_view name;
  Wall Scene::*of_scene;
};
constexpr std::array<Edge, 6> edges{Edge{"floor", &Scene::floor}, Edge{"left", &Scene::left},
                                    Edge{"right", &Scene::right}, Edge{"top", &Scene::top},
                                    Edge{"near", &Scene::near},   Edge{"far", &Scene::far}};

}  // namespace

template <int dim>
std::array<double, dim> Simulation::Impl<dim>::gravity_now() const {
  std::array<double, dim> now = gravity_of<dim>(scene);
  if (!(time < scene.gravity_ramp)) return now;
  const double x = time / scene.gravity_ramp;
  for (double& g : now) g *= x * x * (3.0 - 2.0 * x);
  return now;
}

template <int dim>
void Simulation::Impl<dim>::change_gravity(const std::array<double, dim>& to) {
  const double before = potential();
  const std::array<double, dim> g = std::exchange(gravity, to);
  ledger.start += potential() - before;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const PointsOf<dim>& points = bodies[b];
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double share = buoyant(b, points[Layout<dim>::x + 1][s]);
      for (std::size_t i = 0; i < dim; ++i)
        ledger.power += points[Layout<dim>::mass][s] * (i == 1 ? 1.0 - share : 1.0) *
                        (gravity[i] - g[i]) * points[Layout<dim>::v + i][s];
    }
  }
  if (scene.water_table) tiles_are_current = false;  // they hold what the water bears
}

template <int dim>
void Simulation::Impl<dim>::follow_ramp() {
  if (scene.gravity_ramp > 0.0 && gravity != gravity_of<dim>(scene)) change_gravity(gravity_now());
}

template <int dim>
void Simulation::Impl<dim>::set_gravity(double magnitude, double tilt_deg) {
  Scene changed = scene;
  if (changed.transfer == Transfer::relaxed && !changed.relaxation_time)
    changed.relaxation_time = default_relaxation_time(scene);
  changed.gravity = magnitude;
  changed.tilt_deg = tilt_deg;
  if (!(magnitude >= 0.0) || !std::isfinite(magnitude))
    throw InputError("scene.gravity",
                     fmt::format("gravity = {} m/s2 must be a number >= 0", magnitude));
  if (!(std::abs(tilt_deg) <= 90.0))
    throw InputError("scene.tilt_deg", fmt::format("tilt_deg = {} must be in [-90, 90]", tilt_deg));
  validate(changed);
  changed.gravity_ramp = 0.0;
  scene = changed;
  change_gravity(gravity_of<dim>(scene));
  highest_energy = std::max(highest_energy, energy_bound());
}

template <int dim>
void Simulation::Impl<dim>::set_wall(std::string_view name, const Wall& wall) {
  const std::size_t there = dim == 2 ? 4 : 6;
  const auto* const edge = std::find_if(edges.begin(), edges.begin() + there,
                                        [&](const Edge& e) { return e.name == name; });
  if (edge == edges.begin() + there) {
    std::vector<std::string_view> names;
    for (std::size_t k = 0; k < there; ++k) names.push_back(edges[k].name);
    const std::string near = nearest_name(name, names);
    throw InputError("domain",
                     fmt::format("there is no edge '{}': {}{}", name, fmt::join(names, ", "),
                                 near.empty() ? "" : "; did you mean '" + near + "'?"));
  }
  const auto periodic = [](const Wall& w) { return w.kind == Wall::Kind::periodic; };
  if (periodic(scene.*(edge->of_scene)) != periodic(wall))
    throw InputError(
        fmt::format("domain.{}", name),
        "an edge does not become periodic, or cease to be, while a simulation goes on");
  Scene changed = scene;
  changed.*(edge->of_scene) = wall;
  validate(changed);
  scene = changed;
  walls = walls_now();
  highest_energy = std::max(highest_energy, energy_bound());
}

template std::array<double, 2> Simulation::Impl<2>::gravity_now() const;
template std::array<double, 3> Simulation::Impl<3>::gravity_now() const;
template void Simulation::Impl<2>::change_gravity(const std::array<double, 2>&);
template void Simulation::Impl<3>::change_gravity(const std::array<double, 3>&);
template void Simulation::Impl<2>::follow_ramp();
template void Simulation::Impl<3>::follow_ramp();

void Simulation::set_gravity(double gravity, double tilt_deg) {
  visit([&](auto& s) { s.set_gravity(gravity, tilt_deg); });
}
void Simulation::set_wall(std::string_view edge, const Wall& wall) {
  visit([&](auto& s) { s.set_wall(edge, wall); });
}

}  // namespace repose::mpm
