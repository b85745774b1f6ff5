#include "mpm/simulation.hpp"

#include <algorithm>
#include <numbers>
#include <numeric>

#include <fmt/format.h>
#include <tbb/info.h>

#include "mpm/fill.hpp"
#include "mpm/simulation_impl.hpp"
#include "mpm/step_kinematics.hpp"

namespace repose::mpm {
namespace {

template <int dim>
std::array<double, dim> gravity_vector(const Scene& scene) {
  const double angle = scene.tilt_deg * std::numbers::pi / 180.0;
  return {scene.gravity * std::sin(angle), -scene.gravity * std::cos(angle)};
}

/// Velocity, gradient and affine velocity of points that have just been filled.
void set_motion(PointSet& points, const std::function<PointMotion(double, double)>& motion) {
  for (std::size_t s = 0; s < points.slots(); ++s) {
    const PointMotion at = motion(points[X][s], points[Y][s]);
    points[VX][s] = at.velocity[0];
    points[VY][s] = at.velocity[1];
    for (std::size_t k = 0; k < affine_fields; ++k)
      points[LXX + k][s] = points[points.affine + k][s] = at.gradient[k];
  }
}

int cells(double length, double h) { return static_cast<int>(std::llround(length / h)); }

/// The body whose axis the deposit is measured about, in space; null if there is none.
const Body* first_cylinder(const Scene& scene) {
  const auto found = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                  [](const Body& body) { return body.disc.has_value(); });
  return found == scene.bodies.end() ? nullptr : &*found;
}

template <int dim>
double squared_speed(const PointsOf<dim>& points, std::size_t s) {
  double v2 = 0.0;
  for (std::size_t i = 0; i < dim; ++i)
    v2 += points[Layout<dim>::v + i][s] * points[Layout<dim>::v + i][s];
  return v2;
}

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
      gravity(gravity_vector<dim>(given)),
      walls{given.left, given.right, given.floor, given.top, given.near, given.far},
      grid(given.h, cells<dim>(given)),
      arena(thread_count > 0 ? thread_count : tbb::info::default_concurrency()),
      threads(thread_count > 0 ? thread_count : tbb::info::default_concurrency()),
      prescribed(by_program) {
  std::int64_t next_id = 0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    try {
      bodies.push_back(fill<dim>(body, scene, next_id));
    } catch (const InputError& e) {
      throw InputError(fmt::format("body[{}].{}", b, e.key()), e.what());
    }
    next_id += static_cast<std::int64_t>(bodies.back().count);
    body_names.push_back(body.name.empty() ? fmt::format("body[{}]", b) : body.name);
    initial_height = std::max(initial_height, body.origin[1] + body.size[1]);
  }
  for (PointsOf<dim>& points : bodies)
    if (prescribed.material) points.material = prescribed.material;
  if constexpr (dim == 2) {
    for (PointSet& points : bodies) {
      if (prescribed.start) set_motion(points, prescribed.start);
      if (!prescribed.acceleration) continue;
      start_x.insert(start_x.end(), points.field[X].begin(), points.field[X].end());
      start_y.insert(start_y.end(), points.field[Y].begin(), points.field[Y].end());
    }
  } else if (prescribed.start || prescribed.acceleration) {
    throw InputError("domain.size", "a prescribed motion is for plane strain only");
  }
  sort_if_needed();
  signals = initial_signals();
  first_dt = scene.dt ? *scene.dt : stable_step(signals, scene.courant, grid.h());
  last_dt = first_dt;

  const Energies e = energies();
  ledger.start = e.kinetic + e.potential + e.elastic;
  ledger.start_elastic = e.elastic;
  ledger.kinetic = e.kinetic;
  ledger.power = initial_power();
  // all that could ever become motion: every point in the lowest corner of the box, unstressed; and
  // the round-off of its wave energy where there is nothing else
  const double lowest = std::min({0.0, -gravity[0] * scene.domain[0], -gravity[1] * scene.domain[1],
                                  -gravity[0] * scene.domain[0] - gravity[1] * scene.domain[1]});
  double mass = 0.0;
  for (const PointsOf<dim>& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s)
      if (points.id[s] >= 0) mass += points[Layout<dim>::mass][s];
  highest_energy = ledger.start - mass * lowest + 1e-9 * mass * signals.signal * signals.signal;
  // the work of these has no bound
  const auto drags = [](const Wall& wall) { return wall.speed != 0.0; };
  if (prescribed.acceleration || (walls.periodic() && gravity[0] != 0.0) || drags(walls.left) ||
      drags(walls.right) || drags(walls.floor) || drags(walls.top))
    highest_energy = HUGE_VAL;
}

template <int dim>
Signals Simulation::Impl<dim>::initial_signals() const {
  using F = Layout<dim>;
  Signals found;
  std::vector<double> modulus;
  for (const PointsOf<dim>& points : bodies) {
    PointsOf<dim> copy =
        points;  // the viscosity at rest comes with an update, which must not count
    const Range all{0, copy.slots()};
    std::vector<double> zero(padded(copy.slots()), 0.0);
    std::vector<double> viscosity(zero.size(), 0.0);
    modulus.resize(zero.size());
    typename PointsOf<dim>::Batch batch = copy.batch(all);
    copy.material->modulus(batch, modulus.data());
    if (!copy.material->law().has_stress_memory && !copy.splits_stress()) {
      batch.dt = 1.0;
      batch.strain.fill(zero.data());
      batch.viscosity = viscosity.data();
      copy.material->update(batch);
    }
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double speed = std::sqrt(squared_speed(points, s));
      const double rho = points[F::rho][s];
      found.include({speed, speed + std::sqrt(modulus[s] / rho),
                     2.0 * dim * viscosity[s] / (rho * grid.h() * grid.h())});
    }
  }
  return found;
}

template <int dim>
double Simulation::Impl<dim>::initial_power() const {
  double power = 0.0;
  for (const PointsOf<dim>& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s)
      if (points.id[s] >= 0) power += power_of(points, s, 0.0);
  return power;
}

template <int dim>
double Simulation::Impl<dim>::power_of(const PointsOf<dim>& points, std::size_t s,
                                       double dt) const {
  using F = Layout<dim>;
  std::array<double, F::gradient> L;
  for (std::size_t i = 0; i < L.size(); ++i) L[i] = points[F::L + i][s];
  std::array<double, F::components> stress;
  const auto fields = force_components(points);
  for (std::size_t i = 0; i < stress.size(); ++i) stress[i] = points[fields[i]][s];
  double weight = 0.0;
  for (std::size_t i = 0; i < dim; ++i) weight += gravity[i] * points[F::v + i][s];
  return points[F::mass][s] *
         (weight - stress_power(L, stress, dt, !points.material->law().has_stress_memory) /
                       points[F::rho][s]);
}

template <int dim>
void Simulation::Impl<dim>::remove_outflow() {
  using F = Layout<dim>;
  for (PointsOf<dim>& points : bodies) {
    std::vector<double> stored;
    for (std::size_t s = 0; s < points.slots(); ++s) {
      bool inside = true, finite = true;
      double height = 0.0;  // above the origin, times g
      for (std::size_t i = 0; i < dim; ++i) {
        const double x = points[F::x + i][s];
        finite = finite && std::isfinite(x);
        inside = inside &&
                 ((i == 0 && walls.periodic()) || (x >= 0.0 && x <= grid.h() * grid.cells()[i]));
        height -= gravity[i] * x;
      }
      if (points.id[s] < 0 || (inside && finite)) continue;
      if (!finite)  // no outflow, but a state saved after a failure
        throw NumericalFailure("step " + std::to_string(steps) +
                               " starts from a failed state: point " +
                               std::to_string(points.id[s]) + " has no finite position");
      if (stored.empty()) {
        stored.resize(padded(points.slots()));
        points.material->stored_energy(points.batch({0, points.slots()}), stored.data());
      }
      const double m = points[F::mass][s];
      const double elastic = stored[s] * m / points[F::rho][s];
      const double kinetic = 0.5 * m * squared_speed(points, s);
      ledger.outflow += kinetic + m * height + elastic;
      ledger.outflow_elastic += elastic;
      ledger.outflow_mass += m;
      ledger.kinetic -= kinetic;
      ledger.power -= power_of(points, s, last_dt);
      points.id[s] = -1;
      --points.count;
    }
  }
}

template <int dim>
typename Simulation::Impl<dim>::Energies Simulation::Impl<dim>::energies() {
  using F = Layout<dim>;
  Energies e;
  std::vector<double> stored;
  for (PointsOf<dim>& points : bodies) {
    stored.resize(padded(points.slots()));
    points.material->stored_energy(points.batch({0, points.slots()}), stored.data());
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double m = points[F::mass][s];
      double weight = gravity[0] * points[F::x][s];
      for (std::size_t i = 1; i < dim; ++i) weight += gravity[i] * points[F::x + i][s];
      e.kinetic += 0.5 * m * squared_speed(points, s);
      e.potential -= m * weight;
      e.elastic += stored[s] * m / points[F::rho][s];
    }
  }
  return e;
}

/// Over x and the depth of the box, or over rings about the axis of a cylinder, if there is one.
template <int dim>
Deposit Simulation::Impl<dim>::deposit() const {
  if constexpr (dim == 3) {
    if (const Body* const cylinder = first_cylinder(scene)) {
      const std::array<double, 2>& axis = cylinder->disc->centre;
      double whole = 1.0, room = HUGE_VAL;  // up to the nearest wall that no ring is cut by
      for (const std::size_t k : {0U, 2U}) {
        const double c = axis[k / 2];
        room = std::min({room, scene.domain[k] - c, c == 0.0 ? HUGE_VAL : c});
        if (c == 0.0) whole *= 0.5;
      }
      return Deposit(bodies, grid.h(), static_cast<int>(room / grid.h()), axis, whole);
    }
  }
  return Deposit(bodies, grid.h(), grid.nx(), walls.periodic(), dim == 2 ? 1.0 : scene.domain[2]);
}

template <int dim>
SeriesRow Simulation::Impl<dim>::diagnostics() {
  SeriesRow row{};
  row.time_s = time;
  row.step = steps;
  row.dt_s = last_dt;
  const Energies e = energies();
  row.kinetic_J_per_m = e.kinetic;
  row.potential_J_per_m = e.potential;
  row.elastic_J_per_m = e.elastic;
  row.dissipated_J_per_m =
      ledger.stress_work - (e.elastic + ledger.outflow_elastic - ledger.start_elastic);
  row.transfer_loss_J_per_m = ledger.transfer_loss;
  row.wall_loss_J_per_m = ledger.wall_loss;
  row.energy_residual_J_per_m =
      ledger.start - (e.kinetic + e.potential + e.elastic + row.dissipated_J_per_m +
                      ledger.transfer_loss + ledger.wall_loss + ledger.outflow);
  row.outflow_kg_per_m = ledger.outflow_mass;
  row.density_min = HUGE_VAL;
  row.density_max = 0.0;
  row.front_max_m = 0.0;
  // Σ m (x × v) + m D (A_yx − A_xy), …: what the grid receives; Jiang et al. (2015), APIC
  using F = Layout<dim>;
  const double moment =
      retention(0.0).affine ? scene.h * scene.h / (scene.kernel == Kernel::cubic ? 3.0 : 4.0) : 0.0;
  std::array<double, 3> momentum{}, angular{};
  const Body* const cylinder = dim == 3 ? first_cylinder(scene) : nullptr;
  for (const PointsOf<dim>& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double m = points[F::mass][s];
      row.mass_kg_per_m += m;
      const auto x = [&](std::size_t i) { return points[F::x + i][s]; };
      const auto v = [&](std::size_t i) { return points[F::v + i][s]; };
      for (std::size_t i = 0; i < dim; ++i) momentum[i] += m * v(i);
      /// About the axis that is neither i nor j.
      const auto turning = [&](std::size_t i, std::size_t j) {
        return m * (x(i) * v(j) - x(j) * v(i) +
                    moment * (points[points.affine + dim * j + i][s] -
                              points[points.affine + dim * i + j][s]));
      };
      angular[2] += turning(0, 1);
      if constexpr (dim == 3) {
        angular[0] += turning(1, 2);
        angular[1] += turning(2, 0);
      }
      row.density_min = std::min(row.density_min, points[F::rho][s]);
      row.density_max = std::max(row.density_max, points[F::rho][s]);
      const double reached = cylinder ? std::hypot(x(0) - cylinder->disc->centre[0],
                                                   x(dim - 1) - cylinder->disc->centre[1])
                                      : x(0);
      row.front_max_m = std::max(row.front_max_m, reached);
      if (points[F::stress][s] == 0.0 && points[F::stress + 1][s] == 0.0 &&
          points[F::stress + 2][s] == 0.0)
        ++row.points_separated;
    }
  row.momentum_x = momentum[0];
  row.momentum_y = momentum[1];
  row.momentum_z = momentum[2];
  row.angular_momentum_x = angular[0];
  row.angular_momentum_y = angular[1];
  row.angular_momentum = angular[2];
  if (row.mass_kg_per_m == 0.0) row.density_min = 0.0;  // all has left through an open edge
  const Deposit shape = deposit();
  row.front_99_m = mass_front(bodies, grid.h() * grid.nx(), 0.99, walls.periodic(),
                              cylinder ? &cylinder->disc->centre : nullptr);
  row.front_m = shape.front(0.02 * initial_height);
  row.height_m = shape.depth.front();
  return row;
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
Simulation::Snapshot Simulation::snapshot() const {
  return visit([](const auto& s) { return s.snapshot(); });
}
std::vector<std::string> Simulation::warnings() const {
  return visit([](const auto& s) { return s.warnings(); });
}
Simulation::Counters Simulation::counters() const {
  return visit([](const auto& s) { return s.counters(); });
}

template <int dim>
std::int64_t Simulation::Impl<dim>::live_cells() const {
  std::vector<std::array<int, dim>> with_points;
  for (const PointsOf<dim>& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      std::array<int, dim>& cell = with_points.emplace_back();
      for (std::size_t i = 0; i < dim; ++i)
        cell[i] = static_cast<int>(points[Layout<dim>::x + i][s] / grid.h());
    }
  std::sort(with_points.begin(), with_points.end());
  return std::unique(with_points.begin(), with_points.end()) - with_points.begin();
}

Simulation::Profile Simulation::profile() const {
  const Deposit deposit = visit([](const auto& s) { return s.deposit(); });
  Profile p;
  for (std::size_t i = 0; i < deposit.depth.size(); ++i) {
    p.x_m.push_back(static_cast<double>(i) * deposit.h);
    p.depth_m.push_back(deposit.depth[i]);
  }
  return p;
}

RestPressure Simulation::rest_pressure() const {
  if (!plane_) throw std::logic_error("rest_pressure() is for plane strain");
  const Impl<2>& s = *plane_;
  const double h = s.grid.h();
  return mpm::rest_pressure(s.bodies, h, h * s.grid.nx(), -s.gravity[1], 2.0 * h, 0.25);
}

template <int dim>
Simulation::Snapshot Simulation::Impl<dim>::snapshot() const {
  using F = Layout<dim>;
  constexpr int components = F::components;
  struct Place {
    std::int64_t id;
    std::size_t body, slot;
  };
  std::vector<Place> places;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (std::size_t s = 0; s < bodies[b].slots(); ++s)
      if (bodies[b].id[s] >= 0) places.push_back({bodies[b].id[s], b, s});
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.id < b.id; });

  Snapshot shot;
  for (const Place& place : places) {
    const PointsOf<dim>& points = bodies[place.body];
    const auto at = [&](std::size_t f) { return points[f][place.slot]; };
    Sym<double, components> stress;
    for (std::size_t k = 0; k < F::components; ++k) stress.c[k] = at(F::stress + k);
    shot.x_m.push_back(at(F::x));
    shot.y_m.push_back(at(F::x + 1));
    shot.vx.push_back(at(F::v));
    shot.vy.push_back(at(F::v + 1));
    shot.density.push_back(at(F::rho));
    shot.pressure_Pa.push_back(pressure(stress));
    shot.mises_Pa.push_back(mises(stress));
    const auto L = [&](std::size_t i, std::size_t j) { return at(F::L + i * F::axes + j); };
    Sym<double, components> D{};
    D.c[0] = L(0, 0);
    D.c[1] = L(1, 1);
    D.c[3] = 0.5 * (L(0, 1) + L(1, 0));
    if constexpr (dim == 3) {
      D.c[2] = L(2, 2);
      D.c[4] = 0.5 * (L(1, 2) + L(2, 1));
      D.c[5] = 0.5 * (L(2, 0) + L(0, 2));
    }
    shot.shear_rate.push_back(2.0 * shear_norm(deviator(D)));
    shot.mass.push_back(at(F::mass));
    shot.sxx.push_back(stress[0]);
    shot.syy.push_back(stress[1]);
    shot.szz.push_back(stress[2]);
    shot.sxy.push_back(stress[3]);
    if constexpr (dim == 3) {
      shot.z_m.push_back(at(F::x + 2));
      shot.vz.push_back(at(F::v + 2));
      shot.syz.push_back(stress[4]);
      shot.szx.push_back(stress[5]);
    }
    shot.body.push_back(static_cast<std::int32_t>(place.body));
  }
  return shot;
}

Simulation::Snapshot Simulation::Snapshot::slice(double from, double to) const {
  using Column = std::vector<double> Snapshot::*;
  constexpr std::array<Column, 17> columns{
      &Snapshot::shear_rate,  &Snapshot::mass,     &Snapshot::x_m, &Snapshot::y_m,
      &Snapshot::z_m,         &Snapshot::vx,       &Snapshot::vy,  &Snapshot::vz,
      &Snapshot::density,     &Snapshot::sxx,      &Snapshot::syy, &Snapshot::szz,
      &Snapshot::pressure_Pa, &Snapshot::mises_Pa, &Snapshot::sxy, &Snapshot::syz,
      &Snapshot::szx};
  Snapshot part;
  for (std::size_t k = 0; k < z_m.size(); ++k) {
    if (!(z_m[k] >= from && z_m[k] < to)) continue;
    for (const Column column : columns) (part.*column).push_back((this->*column)[k]);
    part.body.push_back(body[k]);
  }
  return part;
}

FrameView Simulation::Snapshot::view(double time_s) const {
  FrameView frame;
  frame.time_s = time_s;
  frame.x_m = x_m;
  frame.y_m = y_m;
  frame.z_m = z_m;
  frame.scalars = {
      {"density_kg_per_m3", density}, {"pressure_Pa", pressure_Pa}, {"mises_Pa", mises_Pa}};
  frame.vectors = {{"velocity_m_per_s", vx, vy, vz}};
  frame.tensors = {{"stress_Pa", sxx, syy, szz, sxy, syz, szx}};
  frame.integers = {{"body", body}};
  return frame;
}

template <int dim>
std::vector<std::string> Simulation::Impl<dim>::warnings() const {
  std::vector<std::string> list;
  const Impl& s = *this;
  if (s.scene.dt) {
    const double courant =
        std::max(s.fixed_step_excess, *s.scene.dt * s.seen().signal / s.grid.h());
    const double viscous = std::max(s.viscous_step_excess, *s.scene.dt * s.signals.viscous_rate);
    if (courant > safe_courant(s.scene.kernel, dim))
      list.push_back(
          fmt::format("the fixed step dt = {:.3g} s reaches Courant number {:.3g}; with the cubic "
                      "kernel a point on its own is stable to 0.82 (fluid) or 1.02 (mu(I), "
                      "Cam-Clay) and the bulk to 1.36, with the quadratic one to 0.87 of that{}",
                      *s.scene.dt, courant, dim == 3 ? "; in space to 0.82 of that" : ""));
    if (viscous > 1.0)
      list.push_back(
          fmt::format("the fixed step dt = {:.3g} s is {:.3g} times the explicit viscous limit rho "
                      "h^2/({} eta) = {:.3g} s: the "
                      "regularised viscosity is not resolved and the deposit creeps and chatters",
                      *s.scene.dt, viscous, 2 * dim, *s.scene.dt / viscous));
  }
  if (s.wall_corrections > 0)
    list.push_back(
        fmt::format("{} times a point was put back on a wall it had crossed", s.wall_corrections));
  return list;
}

template <int dim>
Simulation::Counters Simulation::Impl<dim>::counters() const {
  const Impl& s = *this;
  double bytes = static_cast<double>(s.grid.point_blocks.size()) *
                     (sizeof(PointBlockOf<dim>) + sizeof(TileOf<dim>)) +
                 static_cast<double>(s.grid.node_blocks.size()) * sizeof(NodeBlockOf<dim>);
  for (const PointsOf<dim>& points : s.bodies)
    bytes += static_cast<double>(points.slots() *
                                 (points.fields * sizeof(double) + sizeof(std::int64_t)));
  std::size_t asleep = 0;
  for (const PointBlockOf<dim>& pb : s.grid.point_blocks)
    asleep += pb.rest.asleep ? pb.points() : 0;
  return {.dt_min_s = s.steps > 0 ? s.dt_min : 0.0,
          .dt_max_s = s.dt_max,
          .wall_corrections = s.wall_corrections,
          .sorts = s.sorts,
          .points_asleep = static_cast<std::int64_t>(asleep),
          .newton_iterations = s.newton_iterations,
          .cg_iterations = s.cg_iterations,
          .memory_MB = bytes / 1e6,
          .threads = s.threads};
}

template <int dim>
std::string Simulation::Impl<dim>::describe(const PointsOf<dim>& points, std::size_t body,
                                            std::size_t slot) const {
  using F = Layout<dim>;
  const auto at = [&](std::size_t f) { return points[f][slot]; };
  const auto list = [&](std::size_t first, std::size_t n, const char* format) {
    std::string text;
    for (std::size_t k = 0; k < n; ++k)
      text += (k > 0 ? ", " : "") + fmt::format(fmt::runtime(format), at(first + k));
    return text;
  };
  static constexpr std::array component{"xx", "yy", "zz", "xy", "yz", "zx"};
  std::string text = fmt::format(
      "point {} of {} ({}) at x = {} m, velocity ({}) m/s, density {:.6g} kg/m3, stress",
      points.id[slot], body_names[body], points.material->law().name,
      dim == 2 ? fmt::format("{:.6g} m, y = {:.6g}", at(F::x), at(F::x + 1))
               : fmt::format("{:.6g} m, y = {:.6g} m, z = {:.6g}", at(F::x), at(F::x + 1),
                             at(F::x + dim - 1)),
      list(F::v, dim, "{:.4g}"), at(F::rho));
  for (std::size_t k = 0; k < F::components; ++k)
    text += fmt::format("{} {} {:.6g}", k > 0 ? "," : "", component[k], at(F::stress + k));
  text += " Pa";
  for (std::size_t k = 0; k < points.state_fields(); ++k)
    text += fmt::format(", {} {:.6g} {}", points.material->law().state[k].name, at(F::state + k),
                        points.material->law().state[k].unit);
  return text;
}

#define REPOSE_SIMULATION(DIM)                                                               \
  template Simulation::Impl<DIM>::Impl(const Scene&, const Prescribed&, int);                \
  template void Simulation::Impl<DIM>::remove_outflow();                                     \
  template double Simulation::Impl<DIM>::power_of(const PointsOf<DIM>&, std::size_t, double) \
      const;                                                                                 \
  template std::string Simulation::Impl<DIM>::describe(const PointsOf<DIM>&, std::size_t,    \
                                                       std::size_t) const;
REPOSE_SIMULATION(2)
REPOSE_SIMULATION(3)
#undef REPOSE_SIMULATION

}  // namespace repose::mpm
