#include "mpm/simulation.hpp"

#include <algorithm>
#include <numbers>
#include <numeric>

#include <fmt/format.h>
#include <tbb/info.h>

#include "mpm/deposit.hpp"
#include "mpm/fill.hpp"
#include "mpm/simulation_impl.hpp"

namespace repose::mpm {
namespace {

std::array<double, 2> gravity_vector(const Scene& scene) {
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

}  // namespace

Simulation::Impl::Impl(const Scene& given, const Prescribed& by_program, int thread_count)
    : scene(given),
      gravity(gravity_vector(given)),
      walls{given.left, given.right, given.floor, given.top},
      grid(given.h, cells(given.domain[0], given.h), cells(given.domain[1], given.h)),
      arena(thread_count > 0 ? thread_count : tbb::info::default_concurrency()),
      threads(thread_count > 0 ? thread_count : tbb::info::default_concurrency()),
      prescribed(by_program) {
  std::int64_t next_id = 0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    try {
      bodies.push_back(fill(body, scene, next_id));
    } catch (const InputError& e) {
      throw InputError(fmt::format("body[{}].{}", b, e.key()), e.what());
    }
    next_id += static_cast<std::int64_t>(bodies.back().count);
    body_names.push_back(body.name.empty() ? fmt::format("body[{}]", b) : body.name);
    initial_height = std::max(initial_height, body.origin[1] + body.size[1]);
  }
  for (PointSet& points : bodies) {
    if (prescribed.start) set_motion(points, prescribed.start);
    if (!prescribed.acceleration) continue;
    start_x.insert(start_x.end(), points.field[X].begin(), points.field[X].end());
    start_y.insert(start_y.end(), points.field[Y].begin(), points.field[Y].end());
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
  for (const PointSet& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s)
      if (points.id[s] >= 0) mass += points[MASS][s];
  highest_energy = ledger.start - mass * lowest + 1e-9 * mass * signals.signal * signals.signal;
  // the work of these has no bound
  const auto drags = [](const Wall& wall) { return wall.speed != 0.0; };
  if (prescribed.acceleration || (walls.periodic() && gravity[0] != 0.0) || drags(walls.left) ||
      drags(walls.right) || drags(walls.floor) || drags(walls.top))
    highest_energy = HUGE_VAL;
}

Signals Simulation::Impl::initial_signals() const {
  Signals found;
  std::vector<double> modulus;
  for (const PointSet& points : bodies) {
    PointSet copy = points;  // the viscosity at rest comes with an update, which must not count
    const Range all{0, copy.slots()};
    std::vector<double> zero(padded(copy.slots()), 0.0);
    std::vector<double> viscosity(zero.size(), 0.0);
    modulus.resize(zero.size());
    Batch batch = copy.batch(all);
    copy.material->modulus(batch, modulus.data());
    if (!copy.material->law().has_stress_memory && !copy.splits_stress()) {
      batch.dt = 1.0;
      batch.strain.fill(zero.data());
      batch.viscosity = viscosity.data();
      copy.material->update(batch);
    }
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double speed = std::hypot(points[VX][s], points[VY][s]);
      const double rho = points[RHO][s];
      found.include({speed, speed + std::sqrt(modulus[s] / rho),
                     4.0 * viscosity[s] / (rho * grid.h() * grid.h())});
    }
  }
  return found;
}

double Simulation::Impl::initial_power() const {
  double power = 0.0;
  for (const PointSet& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s)
      if (points.id[s] >= 0) power += power_of(points, s, 0.0);
  return power;
}

double Simulation::Impl::power_of(const PointSet& points, std::size_t s, double dt) const {
  const auto& stress = points.force_stress;
  const double xx = points[LXX][s], xy = points[LXY][s], yx = points[LYX][s], yy = points[LYY][s];
  double c_xx = dt * (xx * xx + xy * yx), c_yy = dt * (yy * yy + xy * yx), c_zz = 0.0;
  double c = dt * (xx + yy);
  if (!points.material->law().has_stress_memory) {
    c_xx = c_yy = c_zz = (c_xx + c_yy) / 3.0;
    c = 0.0;
  }
  const double zz = points[points.splits_stress() ? stress[0] : std::size_t{SZZ}][s];
  const double stress_power = points[stress[0]][s] * (xx - c_xx) +
                              points[stress[1]][s] * (yy - c_yy) - zz * c_zz +
                              points[stress[2]][s] * (1.0 - c) * (xy + yx);
  return points[MASS][s] *
         (gravity[0] * points[VX][s] + gravity[1] * points[VY][s] - stress_power / points[RHO][s]);
}

void Simulation::Impl::remove_outflow() {
  const double width = grid.h() * grid.nx();
  const double height = grid.h() * grid.ny();
  for (PointSet& points : bodies) {
    std::vector<double> stored;
    for (std::size_t s = 0; s < points.slots(); ++s) {
      const double x = points[X][s];
      const double y = points[Y][s];
      const bool inside = walls.periodic() || (x >= 0.0 && x <= width);
      if (points.id[s] < 0 || (inside && std::isfinite(x) && y >= 0.0 && y <= height)) continue;
      if (!std::isfinite(x) || !std::isfinite(y))  // no outflow, but a state saved after a failure
        throw NumericalFailure("step " + std::to_string(steps) +
                               " starts from a failed state: point " +
                               std::to_string(points.id[s]) + " has no finite position");
      if (stored.empty()) {
        stored.resize(padded(points.slots()));
        points.material->stored_energy(points.batch({0, points.slots()}), stored.data());
      }
      const double m = points[MASS][s];
      const double elastic = stored[s] * m / points[RHO][s];
      const double vx = points[VX][s];
      const double vy = points[VY][s];
      const double kinetic = 0.5 * m * (vx * vx + vy * vy);
      ledger.outflow += kinetic - m * (gravity[0] * x + gravity[1] * y) + elastic;
      ledger.outflow_elastic += elastic;
      ledger.outflow_mass += m;
      ledger.kinetic -= kinetic;
      ledger.power -= power_of(points, s, last_dt);
      points.id[s] = -1;
      --points.count;
    }
  }
}

Simulation::Impl::Energies Simulation::Impl::energies() {
  Energies e;
  std::vector<double> stored;
  for (PointSet& points : bodies) {
    stored.resize(padded(points.slots()));
    points.material->stored_energy(points.batch({0, points.slots()}), stored.data());
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double m = points[MASS][s];
      const double vx = points[VX][s];
      const double vy = points[VY][s];
      e.kinetic += 0.5 * m * (vx * vx + vy * vy);
      e.potential -= m * (gravity[0] * points[X][s] + gravity[1] * points[Y][s]);
      e.elastic += stored[s] * m / points[RHO][s];
    }
  }
  return e;
}

SeriesRow Simulation::Impl::diagnostics() {
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
  // Σ m (x × v) + m D (A_yx − A_xy): what the grid receives; Jiang et al. (2015), APIC
  const double moment =
      retention(0.0).affine ? scene.h * scene.h / (scene.kernel == Kernel::cubic ? 3.0 : 4.0) : 0.0;
  for (const PointSet& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double m = points[MASS][s];
      row.mass_kg_per_m += m;
      row.momentum_x += m * points[VX][s];
      row.momentum_y += m * points[VY][s];
      row.angular_momentum +=
          m * (points[X][s] * points[VY][s] - points[Y][s] * points[VX][s] +
               moment * (points[points.affine + 2][s] - points[points.affine + 1][s]));
      row.density_min = std::min(row.density_min, points[RHO][s]);
      row.density_max = std::max(row.density_max, points[RHO][s]);
      row.front_max_m = std::max(row.front_max_m, points[X][s]);
      if (points[SXX][s] == 0.0 && points[SYY][s] == 0.0 && points[SZZ][s] == 0.0)
        ++row.points_separated;
    }
  if (row.mass_kg_per_m == 0.0) row.density_min = 0.0;  // all has left through an open edge
  const Deposit deposit(bodies, grid.h(), grid.nx(), walls.periodic());
  row.front_99_m = mass_front(bodies, grid.h() * grid.nx(), 0.99, walls.periodic());
  row.front_m = deposit.front(0.02 * initial_height);
  row.height_m = deposit.depth.front();
  return row;
}

Simulation::Simulation(const Scene& scene, int threads)
    : Simulation(scene, Prescribed{}, threads) {}
Simulation::Simulation(const Scene& scene, const Prescribed& prescribed, int threads) {
  validate(scene);
  impl_ = std::make_unique<Impl>(scene, prescribed, threads);
}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;

void Simulation::step(double stop_at) { impl_->step(stop_at); }
const Scene& Simulation::scene() const { return impl_->scene; }
double Simulation::time() const { return impl_->time; }
std::int64_t Simulation::steps() const { return impl_->steps; }
std::int64_t Simulation::point_steps() const { return impl_->point_steps; }
SeriesRow Simulation::diagnostics() const { return impl_->diagnostics(); }

std::int64_t Simulation::point_count() const {
  std::int64_t n = 0;
  for (const PointSet& points : impl_->bodies) n += static_cast<std::int64_t>(points.count);
  return n;
}

std::int64_t Simulation::live_cells() const {
  std::vector<std::pair<int, int>> cells_with_points;
  for (const PointSet& points : impl_->bodies)
    for (std::size_t s = 0; s < points.slots(); ++s)
      if (points.id[s] >= 0)
        cells_with_points.emplace_back(static_cast<int>(points[X][s] / impl_->grid.h()),
                                       static_cast<int>(points[Y][s] / impl_->grid.h()));
  std::sort(cells_with_points.begin(), cells_with_points.end());
  return std::unique(cells_with_points.begin(), cells_with_points.end()) -
         cells_with_points.begin();
}

double Simulation::next_dt() const { return impl_->choose_step(HUGE_VAL); }

Simulation::Profile Simulation::profile() const {
  const Deposit deposit(impl_->bodies, impl_->grid.h(), impl_->grid.nx(), impl_->walls.periodic());
  Profile p;
  for (std::size_t i = 0; i < deposit.depth.size(); ++i) {
    p.x_m.push_back(static_cast<double>(i) * impl_->grid.h());
    p.depth_m.push_back(deposit.depth[i]);
  }
  return p;
}

RestPressure Simulation::rest_pressure() const {
  const Impl& s = *impl_;
  const double h = s.grid.h();
  return mpm::rest_pressure(s.bodies, h, h * s.grid.nx(), -s.gravity[1], 2.0 * h, 0.25);
}

Simulation::Snapshot Simulation::snapshot() const {
  struct Place {
    std::int64_t id;
    std::size_t body, slot;
  };
  std::vector<Place> places;
  for (std::size_t b = 0; b < impl_->bodies.size(); ++b)
    for (std::size_t s = 0; s < impl_->bodies[b].slots(); ++s)
      if (impl_->bodies[b].id[s] >= 0) places.push_back({impl_->bodies[b].id[s], b, s});
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.id < b.id; });

  Snapshot shot;
  for (const Place& place : places) {
    const PointSet& points = impl_->bodies[place.body];
    const auto at = [&](Field f) { return points[f][place.slot]; };
    Sym<double, 4> stress;
    stress.c = {at(SXX), at(SYY), at(SZZ), at(SXY)};
    shot.x_m.push_back(at(X));
    shot.y_m.push_back(at(Y));
    shot.vx.push_back(at(VX));
    shot.vy.push_back(at(VY));
    shot.density.push_back(at(RHO));
    shot.pressure_Pa.push_back(pressure(stress));
    shot.mises_Pa.push_back(mises(stress));
    shot.sxx.push_back(at(SXX));
    shot.syy.push_back(at(SYY));
    shot.szz.push_back(at(SZZ));
    shot.sxy.push_back(at(SXY));
    shot.body.push_back(static_cast<std::int32_t>(place.body));
  }
  return shot;
}

FrameView Simulation::Snapshot::view(double time_s) const {
  FrameView frame;
  frame.time_s = time_s;
  frame.x_m = x_m;
  frame.y_m = y_m;
  frame.scalars = {
      {"density_kg_per_m3", density}, {"pressure_Pa", pressure_Pa}, {"mises_Pa", mises_Pa}};
  frame.vectors = {{"velocity_m_per_s", vx, vy}};
  frame.tensors = {{"stress_Pa", sxx, syy, szz, sxy}};
  frame.integers = {{"body", body}};
  return frame;
}

std::vector<std::string> Simulation::warnings() const {
  std::vector<std::string> list;
  const Impl& s = *impl_;
  if (s.scene.dt) {
    const double courant =
        std::max(s.fixed_step_excess, *s.scene.dt * s.seen().signal / s.grid.h());
    const double viscous = std::max(s.viscous_step_excess, *s.scene.dt * s.signals.viscous_rate);
    if (courant > 0.8)
      list.push_back(
          fmt::format("the fixed step dt = {:.3g} s reaches Courant number {:.3g}; 0.8 is the "
                      "limit for a single point",
                      *s.scene.dt, courant));
    if (viscous > 1.0)
      list.push_back(
          fmt::format("the fixed step dt = {:.3g} s is {:.3g} times the explicit viscous limit rho "
                      "h^2/(4 eta) = {:.3g} s: the "
                      "regularised viscosity is not resolved and the deposit creeps and chatters",
                      *s.scene.dt, viscous, *s.scene.dt / viscous));
  }
  if (s.wall_corrections > 0)
    list.push_back(
        fmt::format("{} times a point was put back on a wall it had crossed", s.wall_corrections));
  return list;
}

Simulation::Counters Simulation::counters() const {
  const Impl& s = *impl_;
  double bytes =
      static_cast<double>(s.grid.point_blocks.size()) * (sizeof(PointBlock) + sizeof(Tile)) +
      static_cast<double>(s.grid.node_blocks.size()) * sizeof(NodeBlock);
  for (const PointSet& points : s.bodies)
    bytes += static_cast<double>(points.slots() *
                                 (points.fields * sizeof(double) + sizeof(std::int64_t)));
  std::size_t asleep = 0;
  for (const PointBlock& pb : s.grid.point_blocks) asleep += pb.rest.asleep ? pb.points() : 0;
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

std::string Simulation::Impl::describe(const PointSet& points, std::size_t body,
                                       std::size_t slot) const {
  std::string text = fmt::format(
      "point {} of {} ({}) at x = {:.6g} m, y = {:.6g} m, velocity ({:.4g}, {:.4g}) m/s, density "
      "{:.6g} kg/m3, stress "
      "xx {:.6g}, yy {:.6g}, zz {:.6g}, xy {:.6g} Pa",
      points.id[slot], body_names[body], points.material->law().name, points[X][slot],
      points[Y][slot], points[VX][slot], points[VY][slot], points[RHO][slot], points[SXX][slot],
      points[SYY][slot], points[SZZ][slot], points[SXY][slot]);
  for (std::size_t k = 0; k < points.state_fields(); ++k)
    text += fmt::format(", {} {:.6g} {}", points.material->law().state[k].name,
                        points[STATE + k][slot], points.material->law().state[k].unit);
  return text;
}

}  // namespace repose::mpm
