/// What a simulation tells about itself: a row of series.csv, warnings, counters, a point in words.

#include <algorithm>

#include <fmt/core.h>

#include "mpm/output/deposit.hpp"
#include "mpm/output/rest_pressure.hpp"
#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {
namespace {

/// The body whose axis the deposit is measured about, in space; null if there is none.
const Body* first_cylinder(const Scene& scene) {
  const auto found = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                  [](const Body& body) { return body.disc.has_value(); });
  return found == scene.bodies.end() ? nullptr : &*found;
}

}  // namespace

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
  row.plastic_J_per_m = ledger.plastic;
  row.viscous_J_per_m = ledger.viscous;
  row.hypoelastic_J_per_m = ledger.hypoelastic;
  row.separation_J_per_m = ledger.separation;
  row.averaging_loss_J_per_m = ledger.averaging;
  row.density_floor_J_per_m = ledger.density_floor;
  row.dissipated_J_per_m = ledger.plastic + ledger.viscous;
  const double unstored = row.dissipated_J_per_m + row.hypoelastic_J_per_m +
                          row.separation_J_per_m + row.averaging_loss_J_per_m +
                          row.density_floor_J_per_m;
  row.work_residual_J_per_m =
      ledger.stress_work -
      (e.elastic + ledger.outflow_elastic - ledger.start_elastic - ledger.inflow_elastic) -
      unstored;
  row.transfer_loss_J_per_m = ledger.transfer_loss;
  row.wall_loss_J_per_m = ledger.wall_loss;
  row.energy_residual_J_per_m = ledger.start + ledger.inflow -
                                (e.kinetic + e.potential + e.elastic + unstored +
                                 ledger.transfer_loss + ledger.wall_loss + ledger.outflow);
  row.outflow_kg_per_m = ledger.outflow_mass;
  row.inflow_kg_per_m = ledger.inflow_mass;
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

template <int dim>
std::vector<std::string> Simulation::Impl<dim>::warnings() const {
  std::vector<std::string> list;
  const Impl& s = *this;
  if (s.equilibrium.sought && !s.equilibrium.found())
    list.push_back(fmt::format(
        "no state at rest was found to start from: {:.2g} of the weight is out of balance ({:.2g} "
        "of the first guess), {} points are at the limit of their strength{}: a slope steeper than "
        "its friction, or something without a hold",
        std::max(s.equilibrium.residual, s.equilibrium.in_step), s.equilibrium.guess,
        s.equilibrium.limited,
        s.equilibrium.residual <= Equilibrium::enough
            ? ", and an edge or surface slides or parts under it"
            : ""));
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
  std::size_t points = 0;
  for (const PointsOf<dim>& body : s.bodies) points += body.count;
  // single grains that fly are no news; a body that comes apart into points is
  if (s.most_points_held * 20 > static_cast<std::int64_t>(points))
    list.push_back(fmt::format(
        "up to {} points at a time ({:.2g} % of all) were so far from all others that the grid "
        "cannot "
        "tell their density, and were held at that of a point alone in its cells: more than spray",
        s.most_points_held,
        100.0 * static_cast<double>(s.most_points_held) /
            static_cast<double>(std::max<std::size_t>(points, 1))));
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
    bytes += static_cast<double>(points.slots() * points.bytes_per_slot());
  return {.dt_min_s = s.steps > 0 ? s.dt_min : 0.0,
          .dt_max_s = s.dt_max,
          .surface_work = s.ledger.surface_work,
          .wall_corrections = s.wall_corrections,
          .sorts = s.sorts,
          .points_held = s.points_held,
          .most_points_held = s.most_points_held,
          .point_steps_held = s.point_steps_held,
          .newton_iterations = s.newton_iterations,
          .cg_iterations = s.cg_iterations,
          .out_of_balance = std::max(s.equilibrium.residual, s.equilibrium.in_step),
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

#define REPOSE_DIAGNOSTICS(DIM)                                                           \
  template Deposit Simulation::Impl<DIM>::deposit() const;                                \
  template SeriesRow Simulation::Impl<DIM>::diagnostics();                                \
  template std::int64_t Simulation::Impl<DIM>::live_cells() const;                        \
  template std::vector<std::string> Simulation::Impl<DIM>::warnings() const;              \
  template Simulation::Counters Simulation::Impl<DIM>::counters() const;                  \
  template std::string Simulation::Impl<DIM>::describe(const PointsOf<DIM>&, std::size_t, \
                                                       std::size_t) const;
REPOSE_DIAGNOSTICS(2)
REPOSE_DIAGNOSTICS(3)
#undef REPOSE_DIAGNOSTICS

Simulation::Profile Simulation::profile() const {
  const Deposit deposit = visit([](const auto& s) { return s.deposit(); });
  Profile p;
  for (std::size_t i = 0; i < deposit.depth.size(); ++i) {
    p.x_m.push_back(static_cast<double>(i) * deposit.h);
    p.depth_m.push_back(deposit.depth[i]);
  }
  return p;
}

RestPressure Simulation::rest_pressure(Stress of) const {
  if (!plane_) throw std::logic_error("rest_pressure() is for plane strain");
  const Impl<2>& s = *plane_;
  const double h = s.grid.h();
  std::vector<double> rho_0;
  for (const PointSet& points : s.bodies) rho_0.push_back(points.rho_0);
  return mpm::rest_pressure(snapshot(of), rho_0, h, h * s.grid.nx(), -s.gravity[1], 2.0 * h, 0.25);
}

}  // namespace repose::mpm
