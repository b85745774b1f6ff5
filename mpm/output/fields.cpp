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
  // what stands for a node behind an edge, or the same node where it is inside; −1: nothing does
  const auto stands_for = [&](std::size_t a, const typename GridOf<dim>::Index& at) {
    const int last = grid.cells()[a], i = at[a];
    if (a == 0 && walls.periodic()) return (i + last) % last;
    const auto is_open = [&](const Wall& wall) {
      if (wall.kind != Wall::Kind::parts) return wall.kind == Wall::Kind::open;
      std::array<int, dim - 1> along{};
      for (std::size_t k = 0; k < along.size(); ++k) along[k] = at[k < a ? k : k + 1];
      return WallParts<dim>(wall, a, grid).node(along).part->kind == Wall::Kind::open;
    };
    if (i < 0) return is_open(walls.low(a)) ? -1 : -i;
    if (i > last) return is_open(walls.high(a)) ? -1 : 2 * last - i;
    return i;
  };
  typename GridOf<dim>::Index index{};
  const auto place_of = [&](const typename GridOf<dim>::Index& at) {
    std::size_t n = 0;
    for (std::size_t a = 0; a < dim; ++a) n = n * all.nodes[a] + static_cast<std::size_t>(at[a]);
    return n;
  };
  const auto visit_axis = [&](const auto& self, std::size_t a) -> void {
    for (index[a] = -1; index[a] <= grid.cells()[a] + 1; ++index[a]) {
      if (a + 1 < dim) {
        self(self, a + 1);
        continue;
      }
      const auto [block, place] = grid.node(index);
      if (block == nullptr || !(block->mass[place] > 0.0)) continue;
      typename GridOf<dim>::Index home{};
      for (std::size_t k = 0; k < dim; ++k) home[k] = stands_for(k, index);
      if (std::any_of(home.begin(), home.end(), [](int i) { return i < 0; })) continue;
      all.mass[place_of(home)] += block->mass[place];
      if (home != index) continue;
      for (std::size_t k = 0; k < dim; ++k)
        all.velocity[dim * place_of(home) + k] = block->v[k][place];
    }
  };
  visit_axis(visit_axis, 0);
  return all;
}

Simulation::PointFields Simulation::point_fields() const {
  return visit([](const auto& s) { return s.point_fields(); });
}
Simulation::NodeFields Simulation::node_fields() const {
  return visit([](auto& s) { return s.node_fields(); });
}

}  // namespace repose::mpm
