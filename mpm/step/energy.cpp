/// The energies of the points, and what leaves with those that cross an open edge.

#include "mpm/step/simulation_impl.hpp"
#include "mpm/step/step_kinematics.hpp"

namespace repose::mpm {

template <int dim>
typename Simulation::Impl<dim>::Energies Simulation::Impl<dim>::energies() {
  using F = Layout<dim>;
  Energies e;
  std::vector<double> stored;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    PointsOf<dim>& points = bodies[b];
    stored.resize(padded(points.slots()));
    points.copy_in_parts([&](std::size_t first, PointsOf<dim>& part, const SlotRange& range) {
      part.material->stored_energy(part.batch(range), stored.data() + first);
    });
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      const double m = points[F::mass][s];
      e.kinetic += 0.5 * m * squared_speed(points, s);
      e.potential += m * height_energy(b, [&](std::size_t i) { return points[F::x + i][s]; });
      e.elastic += stored[s] * m / points[F::rho][s];
    }
  }
  return e;
}

template <int dim>
double Simulation::Impl<dim>::potential() const {
  using F = Layout<dim>;
  double sum = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (std::size_t s = 0; s < bodies[b].slots(); ++s)
      if (bodies[b].id[s] >= 0)
        sum += bodies[b][F::mass][s] *
               height_energy(b, [&](std::size_t i) { return bodies[b][F::x + i][s]; });
  return sum;
}

template <int dim>
double Simulation::Impl<dim>::initial_power() const {
  double power = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (std::size_t s = 0; s < bodies[b].slots(); ++s)
      if (bodies[b].id[s] >= 0) power += power_of(bodies[b], b, s, 0.0);
  return power;
}

template <int dim>
double Simulation::Impl<dim>::power_of(const PointsOf<dim>& points, std::size_t body, std::size_t s,
                                       double dt) const {
  using F = Layout<dim>;
  std::array<double, F::gradient> L;
  for (std::size_t i = 0; i < L.size(); ++i) L[i] = points[F::L + i][s];
  std::array<double, F::components> stress;
  const auto fields = force_components(points);
  for (std::size_t i = 0; i < stress.size(); ++i) stress[i] = points[fields[i]][s];
  double weight = 0.0;
  for (std::size_t i = 0; i < dim; ++i) weight += gravity[i] * points[F::v + i][s];
  weight -= buoyant(body, points[F::x + 1][s]) * gravity[1] * points[F::v + 1][s];
  return points[F::mass][s] *
         (weight - stress_power(L, stress, dt, !points.material->law().has_stress_memory) /
                       points[F::rho][s]);
}

template <int dim>
void Simulation::Impl<dim>::remove_outflow() {
  using F = Layout<dim>;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    PointsOf<dim>& points = bodies[b];
    std::vector<double> stored;
    for (std::size_t s = 0; s < points.slots(); ++s) {
      bool inside = true, finite = true;
      for (std::size_t i = 0; i < dim; ++i) {
        const double x = points[F::x + i][s];
        finite = finite && std::isfinite(x);
        inside = inside &&
                 ((i == 0 && walls.periodic()) || (x >= 0.0 && x <= grid.h() * grid.cells()[i]));
      }
      if (points.id[s] < 0 || (inside && finite)) continue;
      if (!finite)  // no outflow, but a state saved after a failure
        throw NumericalFailure("step " + std::to_string(steps) +
                               " starts from a failed state: point " +
                               std::to_string(points.id[s]) + " has no finite position");
      if (stored.empty()) {
        stored.resize(padded(points.slots()));
        points.copy_in_parts([&](std::size_t first, PointsOf<dim>& part, const SlotRange& range) {
          part.material->stored_energy(part.batch(range), stored.data() + first);
        });
      }
      const double m = points[F::mass][s];
      const double elastic = stored[s] * m / points[F::rho][s];
      const double kinetic = 0.5 * m * squared_speed(points, s);
      const double height = height_energy(b, [&](std::size_t i) { return points[F::x + i][s]; });
      ledger.outflow += kinetic + m * height + elastic;
      ledger.outflow_elastic += elastic;
      ledger.outflow_mass += m;
      ledger.kinetic -= kinetic;
      ledger.power -= power_of(points, b, s, last_dt);
      points.id[s] = -1;
      --points.count;
    }
  }
}

#define REPOSE_ENERGY(DIM)                                                                        \
  template Simulation::Impl<DIM>::Energies Simulation::Impl<DIM>::energies();                     \
  template double Simulation::Impl<DIM>::potential() const;                                       \
  template double Simulation::Impl<DIM>::initial_power() const;                                   \
  template double Simulation::Impl<DIM>::power_of(const PointsOf<DIM>&, std::size_t, std::size_t, \
                                                  double) const;                                  \
  template void Simulation::Impl<DIM>::remove_outflow();
REPOSE_ENERGY(2)
REPOSE_ENERGY(3)
#undef REPOSE_ENERGY

}  // namespace repose::mpm
