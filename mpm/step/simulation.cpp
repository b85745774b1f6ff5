#include "mpm/step/simulation.hpp"

#include <algorithm>

#include <fmt/core.h>
#include <tbb/info.h>

#include "mpm/scene/fill.hpp"
#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {
namespace {

/// Velocity, gradient and affine velocity of points that have just been filled.
void set_motion(PointSet& points, const std::function<PointMotion(double, double)>& motion) {
  for (std::size_t s = 0; s < points.slots(); ++s) {
    const PointMotion at = motion(points[X][s], points[Y][s]);
    points.set(VX, s, at.velocity[0]);
    points.set(VY, s, at.velocity[1]);
    for (std::size_t k = 0; k < affine_fields; ++k)
      for (const std::size_t f : {LXX + k, points.affine + k}) points.set(f, s, at.gradient[k]);
  }
}

int cells(double length, double h) { return static_cast<int>(std::llround(length / h)); }

template <int dim>
std::array<int, dim> cells(const Scene& scene) {
  std::array<int, dim> n;
  for (std::size_t i = 0; i < dim; ++i) n[i] = cells(scene.domain[i], scene.h);
  return n;
}

}  // namespace

template <int dim>
Simulation::Impl<dim>::Impl(const Scene& given, const Prescribed& by_program, int thread_count)
    : scene(given),
      gravity(gravity_of<dim>(given)),
      contact(rigid_surfaces(given)),
      grid(given.h, cells<dim>(given)),
      arena(thread_count > 0 ? thread_count : tbb::info::default_concurrency()),
      threads(thread_count > 0 ? thread_count : tbb::info::default_concurrency()),
      prescribed(by_program) {
  if (!scene.start_from.empty()) {
    for (std::size_t b = 0; b < scene.bodies.size(); ++b)
      body_names.push_back(scene.bodies[b].name.empty() ? fmt::format("body[{}]", b)
                                                        : scene.bodies[b].name);
    start_from(scene.start_from);
  }
  for (std::size_t b = 0; scene.start_from.empty() && b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    try {
      bodies.push_back(fill<dim>(body, scene, next_id));
    } catch (const InputError& e) {
      throw InputError(fmt::format("body[{}].{}", b, e.key()), e.what());
    }
    next_id += static_cast<std::int64_t>(bodies.back().count);
    body_names.push_back(body.name.empty() ? fmt::format("body[{}]", b) : body.name);
    initial_height = std::max(initial_height, body.release ? scene.terrain->release->deepest()
                                                           : body.origin[1] + body.size[1]);
  }
  for (const Probe& tracer : scene.tracers) {
    double nearest = HUGE_VAL;
    traced.push_back(-1);
    for (const PointsOf<dim>& points : bodies)
      for (std::size_t s = 0; s < points.slots(); ++s) {
        double r2 = 0.0;
        for (std::size_t i = 0; i < dim; ++i) {
          const double d = points[Layout<dim>::x + i][s] - tracer.place[i];
          r2 += d * d;
        }
        if (!(r2 < nearest)) continue;
        nearest = r2;
        traced.back() = points.id[s];
      }
  }
  for (const Inflow& inflow : scene.inflows) {
    const Body& body = scene.bodies[inflow.body];
    const InitialPoint state = bodies[inflow.body].material->initial(body.initial);
    entries.push_back({state, speed_of(scene, inflow, state.density), 0});
  }
  if (!scene.inflows.empty() && prescribed.acceleration)
    throw InputError("inflow", "material that comes in has no prescribed acceleration");
  walls = walls_now();
  for (const PointsOf<dim>& points : bodies)
    buoyant_.push_back(buoyant_share(scene, *points.material));
  for (PointsOf<dim>& points : bodies)
    if (prescribed.material) points.material = prescribed.material;
  if constexpr (dim == 2) {
    for (PointSet& points : bodies) {
      if (prescribed.start) set_motion(points, prescribed.start);
      if (!prescribed.acceleration) continue;
      for (std::size_t s = 0; s < points.slots(); ++s) {
        start_x.push_back(points[X][s]);
        start_y.push_back(points[Y][s]);
      }
    }
  } else if (prescribed.start || prescribed.acceleration) {
    throw InputError("domain.size", "a prescribed motion is for plane strain only");
  }
  sort_if_needed();
  seek_equilibrium();
  signals = initial_signals();
  first_dt = scene.dt ? *scene.dt : stable_step(signals, scene.courant, grid.h());
  last_dt = first_dt;

  const Energies e = energies();
  ledger.start = e.kinetic + e.potential + e.elastic;
  ledger.start_elastic = e.elastic;
  ledger.kinetic = e.kinetic;
  ledger.power = initial_power();
  highest_energy = energy_bound();
  if (scene.gravity_ramp > 0.0) change_gravity(gravity_now());
  if constexpr (dim == 3)
    if (scene.terrain) maps.emplace(scene, bodies);
  observe_flow(0.0);
}

template <int dim>
double Simulation::Impl<dim>::energy_bound() const {
  // the work of these has no bound
  const auto drags = [](const Wall& wall) {
    return wall.speed != 0.0 ||
           std::any_of(wall.parts.begin(), wall.parts.end(),
                       [](const Wall::Part& part) { return part.speed != 0.0; });
  };
  if (prescribed.acceleration || !scene.inflows.empty() ||
      (walls.periodic() && gravity[0] != 0.0) || drags(walls.left) || drags(walls.right) ||
      drags(walls.floor) || drags(walls.top) ||
      std::any_of(scene.surfaces.begin(), scene.surfaces.end(),
                  [](const Surface& surface) { return surface.moves(); }))
    return HUGE_VAL;
  const double lowest = std::min({0.0, -gravity[0] * scene.domain[0], -gravity[1] * scene.domain[1],
                                  -gravity[0] * scene.domain[0] - gravity[1] * scene.domain[1]});
  double mass = 0.0;
  for (const PointsOf<dim>& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s)
      if (points.id[s] >= 0) mass += points[Layout<dim>::mass][s];
  return ledger.start - mass * lowest + 1e-9 * mass * signals.signal * signals.signal;
}

template <int dim>
Signals Simulation::Impl<dim>::initial_signals() const {
  Signals found;
  for (const PointsOf<dim>& points : bodies) found.include(signals_of(points));
  return found;
}

template <int dim>
Signals Simulation::Impl<dim>::signals_of(const PointsOf<dim>& points) const {
  using F = Layout<dim>;
  Signals found;
  std::vector<double> modulus, viscosity, zero;
  // the viscosity at rest comes with an update, which must not count
  points.copy_in_parts([&](std::size_t first, PointsOf<dim>& part, const SlotRange& range) {
    const std::size_t n = padded(range.count);
    modulus.resize(n);
    zero.assign(n, 0.0);
    viscosity.assign(n, 0.0);
    typename PointsOf<dim>::Batch batch = part.batch(range);
    part.material->modulus(batch, modulus.data());
    if (!part.material->law().has_stress_memory && !part.splits_stress()) {
      batch.dt = 1.0;
      batch.strain.fill(zero.data());
      batch.viscosity = viscosity.data();
      part.material->update(batch);
    }
    for (std::size_t k = 0; k < range.count; ++k) {
      const std::size_t s = first + k;
      if (points.id[s] < 0) continue;
      const double speed = std::sqrt(squared_speed(points, s));
      const double rho = points[F::rho][s];
      found.include({speed, speed + points.damped_signal * std::sqrt(modulus[k] / rho),
                     2.0 * dim * viscosity[k] / (rho * grid.h() * grid.h())});
    }
  });
  return found;
}

Simulation::Simulation(const Scene& scene, int threads)
    : Simulation(scene, Prescribed{}, threads) {}
Simulation::Simulation(const Scene& scene, const Prescribed& prescribed, int threads) {
  validate(scene);
  if (scene.dimensions() == 2)
    plane_ = std::make_unique<Impl<2>>(scene, prescribed, threads);
  else
    space_ = std::make_unique<Impl<3>>(scene, prescribed, threads);
}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;

void Simulation::step(double stop_at) {
  visit([&](auto& s) { s.step(stop_at); });
}
const Scene& Simulation::scene() const { return plane_ ? plane_->scene : space_->scene; }
double Simulation::time() const {
  return visit([](const auto& s) { return s.time; });
}
std::int64_t Simulation::steps() const {
  return visit([](const auto& s) { return s.steps; });
}
const FlowMaps& Simulation::flow_maps() const {
  if (!space_ || !space_->maps)
    throw InputError("terrain", "only a scene with a terrain has maps of its flow");
  return *space_->maps;
}
Simulation::FlowExtent Simulation::flow_extent() const {
  return flow_maps().extent(space_->bodies);
}
Simulation::PlanMaps Simulation::plan_maps() const {
  const FlowMaps& maps = flow_maps();
  return {maps.columns,   maps.rows,      maps.h,       maps.least_depth,
          maps.depth_max, maps.speed_max, maps.arrival, maps.depth(space_->bodies)};
}
std::int64_t Simulation::point_steps() const {
  return visit([](const auto& s) { return s.point_steps; });
}
SeriesRow Simulation::diagnostics() const {
  return visit([](auto& s) { return s.diagnostics(); });
}
std::int64_t Simulation::point_count() const {
  return visit([](const auto& s) {
    std::int64_t n = 0;
    for (const auto& points : s.bodies) n += static_cast<std::int64_t>(points.count);
    return n;
  });
}
std::int64_t Simulation::live_cells() const {
  return visit([](const auto& s) { return s.live_cells(); });
}
double Simulation::next_dt() const {
  return visit([](const auto& s) { return s.choose_step(HUGE_VAL); });
}
std::vector<std::string> Simulation::warnings() const {
  return visit([](const auto& s) { return s.warnings(); });
}
Simulation::Counters Simulation::counters() const {
  return visit([](const auto& s) { return s.counters(); });
}

template Signals Simulation::Impl<2>::signals_of(const PointSet&) const;
template Signals Simulation::Impl<3>::signals_of(const PointsOf<3>&) const;
template double Simulation::Impl<2>::energy_bound() const;
template double Simulation::Impl<3>::energy_bound() const;
template Simulation::Impl<2>::Impl(const Scene&, const Prescribed&, int);
template Simulation::Impl<3>::Impl(const Scene&, const Prescribed&, int);

}  // namespace repose::mpm
