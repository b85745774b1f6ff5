/// What probes see at a place, and where the points of tracers are.
///
/// A probe weighs the points by the products w of 1 − |x − x_p|/h over all directions, those within
/// a cell: velocities and densities by mass, Σ m w v/Σ m w, stresses by volume. The solid depth is
/// that of the column within a cell, Σ m w/ρ_0 over the width that w has inside the box.

#include "models/sym.hpp"
#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {
namespace {

/// 1 − |d| up to 1, then 0.
double hat(double d) { return std::max(0.0, 1.0 - std::abs(d)); }

/// ∫ hat over what of it lies between two walls, distances below and above it in cells.
double hat_inside(double below, double above) {
  const auto beyond = [](double wall) { return 0.5 * hat(wall) * hat(wall); };
  return 1.0 - beyond(below) - beyond(above);
}

template <int dim>
void add_stress(const PointsOf<dim>& points, std::size_t s, double factor,
                std::array<double, Layout<dim>::components>& stress) {
  for (std::size_t k = 0; k < stress.size(); ++k)
    stress[k] += factor * points[Layout<dim>::stress + k][s];
}

template <int dim>
void set_invariants(Simulation::Sight& sight,
                    const std::array<double, Layout<dim>::components>& stress) {
  const Sym<double, static_cast<int>(Layout<dim>::components)> sigma{stress};
  sight.pressure = -mean(sigma);
  const auto s = deviator(sigma);
  double ss = 0.0;
  for (std::size_t k = 0; k < stress.size(); ++k) ss += (k < 3 ? 1.0 : 2.0) * s.c[k] * s.c[k];
  sight.q = std::sqrt(1.5 * ss);
}

}  // namespace

template <int dim>
Simulation::Sight Simulation::Impl<dim>::look_at(const std::array<double, 3>& place) const {
  using F = Layout<dim>;
  Sight sight;
  const double h = grid.h();
  double width = 1.0;  // of the column, along all but y
  for (std::size_t i = 0; i < dim; ++i) {
    sight.position[i] = place[i];
    if (i == 1 || (i == 0 && walls.periodic())) {
      if (i == 0) width *= h;
      continue;
    }
    width *= h * hat_inside(place[i] / h, grid.cells()[i] - place[i] / h);
  }
  const double period = h * grid.cells()[0];
  std::array<double, F::components> stress{};
  double volume = 0.0;
  for (const PointsOf<dim>& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] < 0) continue;
      double column = 1.0, w = 1.0;
      for (std::size_t i = 0; i < dim; ++i) {
        double d = points[F::x + i][s] - place[i];
        if (i == 0 && walls.periodic()) d = std::remainder(d, period);
        w *= hat(d / h);
        if (i != 1) column *= hat(d / h);
      }
      const double m = points[F::mass][s];
      sight.depth += m * column / (points.rho_0 * width);
      if (w == 0.0) continue;
      const double rho = points[F::rho][s];
      sight.mass += m * w;
      sight.density += m * w * rho;
      for (std::size_t i = 0; i < dim; ++i) sight.velocity[i] += m * w * points[F::v + i][s];
      volume += m * w / rho;
      add_stress<dim>(points, s, m * w / rho, stress);
    }
  if (sight.mass == 0.0) return sight;
  sight.density /= sight.mass;
  for (double& v : sight.velocity) v /= sight.mass;
  for (double& c : stress) c /= volume;
  set_invariants<dim>(sight, stress);
  return sight;
}

template <int dim>
Simulation::Sight Simulation::Impl<dim>::tracer(std::size_t k) const {
  using F = Layout<dim>;
  Sight sight;
  for (const PointsOf<dim>& points : bodies)
    for (std::size_t s = 0; s < points.slots(); ++s) {
      if (points.id[s] != traced.at(k)) continue;
      sight.mass = points[F::mass][s];
      sight.density = points[F::rho][s];
      for (std::size_t i = 0; i < dim; ++i) {
        sight.position[i] = points[F::x + i][s];
        sight.velocity[i] = points[F::v + i][s];
      }
      std::array<double, F::components> stress{};
      add_stress<dim>(points, s, 1.0, stress);
      set_invariants<dim>(sight, stress);
      return sight;
    }
  return sight;
}

Simulation::Sight Simulation::look_at(const std::array<double, 3>& place) const {
  return visit([&](const auto& s) { return s.look_at(place); });
}
Simulation::Sight Simulation::tracer(std::size_t k) const {
  return visit([&](const auto& s) { return s.tracer(k); });
}

}  // namespace repose::mpm
