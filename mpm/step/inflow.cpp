/// Material that comes in through an edge of the box.
///
/// It comes in rows, a point spacing apart, as wide as its stretch of the edge: row k is over the
/// edge at t_k = starts + (k + ½) Δ/U, and is made at the beginning of the first step after that,
/// as far inside as it has come. The mass that has come in is that of whole rows, ρ U A t to half a
/// row. While it flows the stretch is a part of the edge whose nodes move inwards with U
/// (walls.hpp), and two cells more of it at either end, so that no point of a row meets a node that
/// does not.

#include "mpm/scene/fill.hpp"
#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {

template <int dim>
Walls Simulation::Impl<dim>::walls_now() const {
  Walls now{scene.left, scene.right, scene.floor, scene.top, scene.near, scene.far};
  Wall* const edges[] = {&now.left, &now.right, &now.floor, &now.top, &now.near, &now.far};
  for (std::size_t k = 0; k < scene.inflows.size(); ++k) {
    if (!flows(k)) continue;
    const Inflow& inflow = scene.inflows[k];
    Wall& wall = *edges[inflow.edge];
    Wall::Part part{Wall::Kind::inflow, 0.0, entries[k].speed, inflow.from, inflow.to};
    for (std::size_t i = 0; i < 2; ++i) {
      part.from[i] -= 1.5 * scene.h;
      part.to[i] += 1.5 * scene.h;
    }
    if (wall.kind != Wall::Kind::parts) {
      Wall::Part rest;
      rest.kind = wall.kind;
      rest.friction = wall.friction;
      rest.speed = wall.speed;
      wall.parts = {rest};
      wall.kind = Wall::Kind::parts;
    }
    wall.parts.insert(wall.parts.begin(), part);
  }
  return now;
}

template <int dim>
void Simulation::Impl<dim>::let_in() {
  using F = Layout<dim>;
  if (scene.inflows.empty()) return;
  walls = walls_now();
  const double spacing = point_spacing(scene);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const Inflow& inflow = scene.inflows[k];
    Entry& entry = entries[k];
    const std::size_t axis = inflow.edge / 2;
    const bool low = inflow.edge % 2 == 0;
    const Stretch stretch = stretch_of(scene, inflow);
    std::array<std::size_t, dim - 1> along{};
    std::array<std::int64_t, 2> points{1, 1};
    for (std::size_t i = 0; i < along.size(); ++i) {
      along[i] = i < axis ? i : i + 1;
      points[i] = std::llround((stretch.to[i] - stretch.from[i]) / spacing);
    }
    PointsOf<dim>& body = bodies[inflow.body];
    for (;; ++entry.rows) {
      const double over =
          inflow.starts + (static_cast<double>(entry.rows) + 0.5) * spacing / entry.speed;
      if (!(over <= time && over < inflow.stops)) break;
      PointsOf<dim> row;
      row.material = body.material;
      row.rho_0 = body.rho_0;
      row.fields = body.fields;
      row.shear_strain = body.shear_strain;
      row.affine = body.affine;
      row.force_stress = body.force_stress;
      row.damping_length = body.damping_length;
      row.damped_signal = body.damped_signal;
      row.single = body.single;
      const double way = std::max(entry.speed * (time - over), 1e-9 * grid.h());
      std::array<double, dim> velocity{};
      velocity[axis] = low ? entry.speed : -entry.speed;
      for (std::int64_t n = 0; n < points[0] * points[1]; ++n) {
        const std::array place{n % points[0], n / points[0]};
        std::array<double, dim> x{};
        x[axis] = low ? way : scene.domain[axis] - way;
        for (std::size_t i = 0; i < along.size(); ++i)
          x[along[i]] = stretch.from[i] + (static_cast<double>(place[i]) + 0.5) * spacing;
        add_point<dim>(row, x, velocity, 0.0, entry.state, std::pow(spacing, dim), next_id++);
      }
      std::vector<double> stored(padded(row.slots()));
      row.copy_in_parts([&](std::size_t first, PointsOf<dim>& part, const SlotRange& range) {
        part.material->stored_energy(part.batch(range), stored.data() + first);
      });
      for (std::size_t s = 0; s < row.slots(); ++s) {
        const double m = row[F::mass][s];
        const double height =
            height_energy(inflow.body, [&](std::size_t i) { return row[F::x + i][s]; });
        const double kinetic = 0.5 * m * squared_speed(row, s);
        const double elastic = stored[s] * m / row[F::rho][s];
        ledger.inflow += kinetic + m * height + elastic;
        ledger.inflow_elastic += elastic;
        ledger.inflow_mass += m;
        ledger.kinetic += kinetic;
        ledger.power += power_of(row, inflow.body, s, last_dt);
        for (std::size_t f = 0; f < row.fields; ++f) body.append(f, row[f][s]);
        body.id.push_back(row.id[s]);
      }
      body.count += row.count;
      signals.include(signals_of(row));
      must_sort = true;
    }
  }
}

template Walls Simulation::Impl<2>::walls_now() const;
template Walls Simulation::Impl<3>::walls_now() const;
template void Simulation::Impl<2>::let_in();
template void Simulation::Impl<3>::let_in();

}  // namespace repose::mpm
