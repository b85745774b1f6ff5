#include "study/run/terrain_result.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "io/coordinate_system.hpp"
#include "io/level_lines.hpp"
#include "io/raster_file.hpp"

namespace repose::study {
namespace {

using mpm::Simulation;

/// What each hat function of a line of nodes 0, h, 2h, … (count of them) gives to the mean over
/// [from, to], which lies among them.
struct Shares {
  std::size_t first = 0;
  std::vector<double> of;
};
Shares shares_of(double from, double to, double h, std::size_t count) {
  /// ∫ of the hat of node n up to x.
  const auto integral = [&](std::size_t n, double x) {
    const double t = std::clamp(x / h - static_cast<double>(n), -1.0, 1.0);
    return h * (t < 0.0 ? 0.5 * (1.0 + t) * (1.0 + t) : 0.5 + t - 0.5 * t * t);
  };
  Shares shares;
  shares.first = static_cast<std::size_t>(std::floor(from / h));
  for (std::size_t n = shares.first; n < count && static_cast<double>(n) * h < to + h; ++n)
    shares.of.push_back((integral(n, to) - integral(n, from)) / (to - from));
  return shares;
}

/// Means over the cells of `frame`, whose corner is that of the nodes, of what `value(node)` says
/// where `counts(node)`, over the nodes that count; no data where they have less than half the
/// weight.
template <class Value, class Counts>
io::Raster means(const io::Raster& frame, const Simulation::PlanMaps& plan, Value&& value,
                 Counts&& counts, double otherwise) {
  io::Raster map = frame;
  map.values.assign(map.columns * map.rows, std::nan(""));
  const double width = plan.h * static_cast<double>(plan.columns - 1);
  const double depth = plan.h * static_cast<double>(plan.rows - 1);
  const auto line = [&](std::size_t cells, std::size_t nodes, double length) {
    std::vector<Shares> shares;
    for (std::size_t n = 0; n < cells; ++n) {
      const double from = map.cell * static_cast<double>(n);
      const double to = std::min(from + map.cell, length);
      // a cell that lies in the box by less than half has no mean
      shares.push_back(to - from < 0.5 * map.cell ? Shares{} : shares_of(from, to, plan.h, nodes));
    }
    return shares;
  };
  const std::vector<Shares> along = line(map.columns, plan.columns, width);
  const std::vector<Shares> across = line(map.rows, plan.rows, depth);
  for (std::size_t row = 0; row < map.rows; ++row)
    for (std::size_t column = 0; column < map.columns; ++column) {
      const Shares &u = along[column], &w = across[row];
      if (u.of.empty() || w.of.empty()) continue;
      double sum = 0.0, weight = 0.0;
      for (std::size_t k = 0; k < w.of.size(); ++k)
        for (std::size_t i = 0; i < u.of.size(); ++i) {
          const std::size_t node = (w.first + k) * plan.columns + u.first + i;
          if (!counts(node)) continue;
          sum += w.of[k] * u.of[i] * value(node);
          weight += w.of[k] * u.of[i];
        }
      map.at(row, column) = weight < 0.5 ? otherwise : sum / weight;
    }
  return map;
}

}  // namespace

TerrainMaps terrain_maps(const Simulation& simulation) {
  const Simulation::PlanMaps plan = simulation.plan_maps();
  io::Raster frame = simulation.scene().terrain->ground_map;
  frame.values.clear();
  const auto everywhere = [](std::size_t) { return true; };
  const auto reached = [&](std::size_t n) { return plan.arrival_s[n] < HUGE_VAL; };
  const auto of = [](const std::vector<double>& values) {
    return [&values](std::size_t n) { return values[n]; };
  };
  return {means(frame, plan, of(plan.depth_max_m), everywhere, 0.0),
          means(frame, plan, of(plan.speed_max), reached, 0.0),
          means(frame, plan, of(plan.arrival_s), reached, std::nan("")),
          means(frame, plan, of(plan.depth_m), everywhere, 0.0)};
}

void write_terrain_maps(const io::ResultFolder& folder, const Simulation& simulation) {
  const mpm::Terrain& terrain = *simulation.scene().terrain;
  const TerrainMaps maps = terrain_maps(simulation);
  constexpr int digits = 3;  // mm and ms
  const auto write = [&](const std::string& name, const io::Raster& map) {
    if (terrain.geotiff) {
      folder.write_file(name + ".tif", io::geotiff_of(map, digits, terrain.crs));
      return;
    }
    folder.write_file(name + ".asc", io::esri_grid_text(map, digits));
    if (!terrain.crs.empty()) folder.write_file(name + ".prj", terrain.crs);
  };
  write("largest_depth", maps.largest_depth_m);
  write("largest_speed", maps.largest_speed);
  write("arrival_time", maps.arrival_s);
  write("deposit", maps.deposit_m);
  const Simulation::PlanMaps plan = simulation.plan_maps();
  const auto outline = [&](const std::vector<double>& depth) {
    return io::regions_above({plan.columns, plan.rows, terrain.ground_map.west,
                              terrain.ground_map.north(), plan.h, -plan.h, depth},
                             plan.least_depth);
  };
  const std::string epsg = io::epsg_of(terrain.crs);
  folder.write_file(
      "outlines.geojson",
      io::geojson_text({{"reached", outline(plan.depth_max_m)}, {"deposit", outline(plan.depth_m)}},
                       epsg.empty() ? "" : "urn:ogc:def:crs:EPSG::" + epsg));
}

std::string flow_extent(const Simulation& simulation) {
  const Simulation::PlanMaps plan = simulation.plan_maps();
  const Simulation::FlowExtent extent = simulation.flow_extent();
  const auto largest = [](const std::vector<double>& values) {
    return *std::max_element(values.begin(), values.end());
  };
  return fmt::format(
      "largest depth {:.3g} m, largest speed {:.3g} m/s, {:.4g} m² reached, run-out {:.4g} m (99 "
      "%), "
      "{:.4g} m (farthest)",
      largest(plan.depth_max_m), largest(plan.speed_max), extent.reached_m2, extent.runout_99_m,
      extent.runout_max_m);
}

}  // namespace repose::study
