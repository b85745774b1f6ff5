/// All that points carry and all that nodes hold, for programs that look at them.

#include <algorithm>
#include <limits>

#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {

template <int dim>
Simulation::PointFields Simulation::Impl<dim>::point_fields() const {
  using F = Layout<dim>;
  struct Place {
    std::int64_t id;
    std::size_t body, slot;
  };
  std::vector<Place> places;
  PointFields all;
  all.dimensions = dim;
  all.components = F::components;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    all.state_width = std::max(all.state_width, bodies[b].state_fields());
    for (std::size_t s = 0; s < bodies[b].slots(); ++s)
      if (bodies[b].id[s] >= 0) places.push_back({bodies[b].id[s], b, s});
  }
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.id < b.id; });
  for (const Place& place : places) {
    const PointsOf<dim>& points = bodies[place.body];
    const auto append = [&](std::vector<double>& to, std::size_t first, std::size_t count) {
      for (std::size_t k = 0; k < count; ++k) to.push_back(points[first + k][place.slot]);
    };
    all.id.push_back(place.id);
    all.body.push_back(static_cast<std::int32_t>(place.body));
    append(all.position, F::x, dim);
    append(all.velocity, F::v, dim);
    append(all.velocity_gradient, F::L, F::gradient);
    append(all.stress, F::stress, F::components);
    append(all.density, F::rho, 1);
    append(all.mass, F::mass, 1);
    append(all.state, F::state, points.state_fields());
    all.state.insert(all.state.end(), all.state_width - points.state_fields(),
                     std::numeric_limits<double>::quiet_NaN());
  }
  return all;
}

template <int dim>
Simulation::NodeFields Simulation::Impl<dim>::node_fields() {
  NodeFields all;
  std::size_t count = 1;
  for (const int cells : grid.cells()) {
    all.nodes.push_back(static_cast<std::size_t>(cells) + 1);
    count *= all.nodes.back();
  }
  all.mass.assign(count, 0.0);
  all.velocity.assign(dim * count, 0.0);
  if (steps == 0) return all;
  for (std::size_t n = 0; n < count; ++n) {
    typename GridOf<dim>::Index index{};
    std::size_t rest = n;
    for (std::size_t a = dim; a-- > 0; rest /= all.nodes[a])
      index[a] = static_cast<int>(rest % all.nodes[a]);
    const auto [block, place] = grid.node(index);
    if (block == nullptr || !(block->mirrored_mass[place] > 0.0)) continue;
    all.mass[n] = block->mirrored_mass[place];
    for (std::size_t a = 0; a < dim; ++a) all.velocity[dim * n + a] = block->v[a][place];
  }
  return all;
}

Simulation::PointFields Simulation::point_fields() const {
  return visit([](const auto& s) { return s.point_fields(); });
}
Simulation::NodeFields Simulation::node_fields() const {
  return visit([](auto& s) { return s.node_fields(); });
}

}  // namespace repose::mpm
