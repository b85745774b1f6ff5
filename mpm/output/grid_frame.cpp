#include "mpm/output/grid_frame.hpp"

namespace repose::mpm {

io::GridView GridFrame::view(const Simulation& simulation) {
  const Simulation::NodeFields fields = simulation.node_fields();
  const std::size_t axes = fields.nodes.size(), count = fields.mass.size();
  io::GridView grid;
  grid.time_s = simulation.time();
  grid.h_m = simulation.scene().h;
  grid.nodes = {fields.nodes[0], fields.nodes[1], axes == 3 ? fields.nodes[2] : 1};
  const auto [nx, ny, nz] = grid.nodes;
  for (std::vector<double>* const values : {&mass_, &vx_, &vy_}) values->resize(count);
  vz_.resize(axes == 3 ? count : 0);
  // the last axis is fastest there, the first one here
  std::size_t from = 0;
  for (std::size_t i = 0; i < nx; ++i)
    for (std::size_t j = 0; j < ny; ++j)
      for (std::size_t k = 0; k < nz; ++k, ++from) {
        const std::size_t to = (k * ny + j) * nx + i;
        mass_[to] = fields.mass[from];
        vx_[to] = fields.velocity[axes * from];
        vy_[to] = fields.velocity[axes * from + 1];
        if (axes == 3) vz_[to] = fields.velocity[axes * from + 2];
      }
  grid.scalars.push_back({axes == 3 ? "mass_kg" : "mass_kg_per_m", mass_});
  grid.vectors.push_back({"velocity_m_per_s", vx_, vy_, vz_});
  return grid;
}

}  // namespace repose::mpm
