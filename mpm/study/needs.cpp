#include "mpm/study/needs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <unistd.h>

#include "models/registry.hpp"
#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {
namespace {

/// Blocks that a length of cells may touch.
double blocks_of(double cells, int block_cells, double more) {
  return std::ceil(cells / block_cells) + more;
}

template <int dim>
Needs needs_in(const Scene& scene) {
  Needs needs;
  double tables = 1.0, nodes = 1.0;
  needs.box_cells = 1.0;
  for (std::size_t k = 0; k < dim; ++k) {
    const double cells = scene.domain[k] / scene.h;
    needs.box_cells *= cells;
    nodes *= cells + 1.0;
    tables *= blocks_of(cells + 2.0, Shape<dim>::cells[k], 3.0);
  }
  double slots_bytes = 0.0, point_blocks = 0.0, node_blocks = 0.0;
  for (const Body& body : scene.bodies) {
    double own = 1.0, around = 1.0;
    for (std::size_t k = 0; k < dim; ++k) {
      own *= blocks_of(body.size[k] / scene.h, Shape<dim>::cells[k], 1.0);
      around *= blocks_of(body.size[k] / scene.h, Shape<dim>::cells[k], 3.0);
    }
    const double points = expected_points(scene, body);
    needs.points += points;
    // what is released lies as a sheet in the box around it, of the blocks that its area takes
    if (body.release) {
      const auto& [x, y, z] = Shape<3>::cells;
      const double sheet = scene.terrain->release->volume() / std::pow(scene.h, 3);
      own = std::min(own, 2.0 * sheet / (x * z) + sheet / (x * y * z));
      around = std::min(around, 3.0 * own);
    }
    const double field_bytes =
        scene.storage == Storage::single_precision ? sizeof(float) : sizeof(double);
    const double fields = static_cast<double>(
        Layout<dim>::state + std::max(std::size_t{4}, find_law(body.law).state.size()) +
        (body.restitution ? PointsOf<dim>::force_components : std::size_t{0}) +
        (scene.transfer == Transfer::relaxed ? Layout<dim>::gradient : std::size_t{0}));
    const std::array<std::int64_t, 3> lattice = point_lattice(scene, body);
    const double slots = body.release || (is_cut(body) && !is_plain_polygon(body))
                             ? points
                             : static_cast<double>(lattice[0]) * static_cast<double>(lattice[1]) *
                                   static_cast<double>(lattice[2]);
    slots_bytes += slots * (fields * field_bytes + sizeof(std::int64_t));
    point_blocks += own;
    node_blocks += around;
  }
  // sorting holds keys and an order beside the points, and a field twice; while material spreads
  // the blocks near it grow, by the half of them or so
  const double of_points = 1.4 * slots_bytes;
  const double of_grid = 1.5 * (point_blocks * (sizeof(PointBlockOf<dim>) + sizeof(TileOf<dim>)) +
                                node_blocks * sizeof(NodeBlockOf<dim>));
  const double of_tables = tables * (2.0 * sizeof(std::int32_t) + sizeof(std::size_t));
  // a frame of the grid is of the whole box: mass and velocity twice, the vector side by side, and
  // the file three times (within HDF5, as its image, sealed)
  constexpr double of_node = (2.0 * (1.0 + dim) + 3.0 + 3.0 * 4.0) * sizeof(double);
  if (scene.grid_frames && scene.frame_interval > 0.0) needs.grid_frames_MB = nodes * of_node / 1e6;
  needs.memory_MB = (of_points + of_grid + of_tables) / 1e6 + needs.grid_frames_MB;
  return needs;
}

}  // namespace

Needs needs_of(const Scene& scene) {
  return scene.dimensions() == 2 ? needs_in<2>(scene) : needs_in<3>(scene);
}

double machine_memory_MB() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), size = ::sysconf(_SC_PAGESIZE);
  return pages > 0 && size > 0 ? static_cast<double>(pages) * static_cast<double>(size) / 1e6
                               : HUGE_VAL;
}

void require_memory(const Scene& scene, double available_MB) {
  const Needs needs = needs_of(scene);
  if (needs.memory_MB <= available_MB) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "%.3g points and a box of %.3g cells take about %.2g GB of memory, and this "
                "machine has %.2g GB; a larger h takes less",
                needs.points, needs.box_cells, needs.memory_MB / 1e3, available_MB / 1e3);
  throw InputError("grid.h", text);
}

}  // namespace repose::mpm
