#include "mpm/scene/terrain.hpp"

#include <algorithm>
#include <cmath>

namespace repose::mpm {
namespace {

/// Length that two intervals have in common.
double common(double low, double high, double from, double to) {
  return std::max(0.0, std::min(high, to) - std::max(low, from));
}

}  // namespace

Release::Release(const io::Raster& depths, double west, double north)
    : map_(depths),
      low_{HUGE_VAL, HUGE_VAL},
      high_{-HUGE_VAL, -HUGE_VAL} {
  map_.west -= west;
  map_.south = north - depths.north();  // z of the first row's northern edge
  for (double& depth : map_.values)
    if (std::isnan(depth)) depth = 0.0;
  for (std::size_t row = 0; row < map_.rows; ++row)
    for (std::size_t column = 0; column < map_.columns; ++column) {
      if (!(map_.at(row, column) > 0.0)) continue;
      deepest_ = std::max(deepest_, map_.at(row, column));
      const std::array<double, 2> corner{map_.west + map_.cell * static_cast<double>(column),
                                         map_.south + map_.cell * static_cast<double>(row)};
      for (std::size_t k = 0; k < 2; ++k) {
        low_[k] = std::min(low_[k], corner[k]);
        high_[k] = std::max(high_[k], corner[k] + map_.cell);
      }
    }
}

Release::Release(const std::vector<io::Region>& regions, double depth, double west, double north)
    : low_{HUGE_VAL, HUGE_VAL},
      high_{-HUGE_VAL, -HUGE_VAL} {
  for (const io::Region& region : regions) {
    const double own = region.depth.value_or(depth);
    deepest_ = std::max(deepest_, own);
    const auto add = [&](const io::Ring& ring, double sign) {
      Part part{{}, sign * own};
      for (const auto& [east, northing] : ring)
        part.outline.corners.push_back({east - west, north - northing});
      for (const auto& corner : part.outline.corners)
        for (std::size_t k = 0; k < 2; ++k) {
          low_[k] = std::min(low_[k], corner[k]);
          high_[k] = std::max(high_[k], corner[k]);
        }
      parts_.push_back(std::move(part));
    };
    add(region.outer, 1.0);
    for (const io::Ring& hole : region.holes) add(hole, -1.0);
  }
}

double Release::volume() const {
  double volume = 0.0;
  for (const double depth : map_.values) volume += std::max(0.0, depth) * map_.cell * map_.cell;
  for (const Part& part : parts_) volume += part.depth * piece_of(part.outline).area;
  return volume;
}

double Release::volume_over(const std::array<double, 2>& low,
                            const std::array<double, 2>& high) const {
  double volume = 0.0;
  if (map_.columns > 0) {
    const auto index = [&](double at, double start, std::size_t count) {
      const double cells = std::floor((at - start) / map_.cell);
      return static_cast<std::size_t>(std::clamp(cells, 0.0, static_cast<double>(count) - 1.0));
    };
    const std::size_t first = index(low[0], map_.west, map_.columns),
                      last = index(high[0], map_.west, map_.columns);
    for (std::size_t row = index(low[1], map_.south, map_.rows);
         row <= index(high[1], map_.south, map_.rows); ++row) {
      const double z = map_.south + map_.cell * static_cast<double>(row);
      const double deep = common(low[1], high[1], z, z + map_.cell);
      for (std::size_t column = first; column <= last; ++column) {
        const double x = map_.west + map_.cell * static_cast<double>(column);
        volume +=
            std::max(0.0, map_.at(row, column)) * deep * common(low[0], high[0], x, x + map_.cell);
      }
    }
  }
  for (const Part& part : parts_)
    volume += part.depth * piece_of(clipped(part.outline, low, high)).area;
  return volume;
}

Surface Terrain::surface() const {
  Surface ground_surface;
  ground_surface.name = "ground";
  ground_surface.solid.shape = Ground{ground};
  ground_surface.contact = contact;
  ground_surface.friction = friction;
  ground_surface.friction_map = friction_map;
  return ground_surface;
}

void Terrain::place() {
  const double west = ground_map.west, north = ground_map.north();
  /// Through the middles of a map's cells.
  const auto through = [&](const io::Raster& map, double level) {
    std::vector<double> heights(map.values);
    for (double& y : heights) y -= level;
    return std::make_shared<const HeightMap>(
        std::array<double, 2>{map.west + 0.5 * map.cell - west,
                              north - map.north() + 0.5 * map.cell},
        map.cell, map.columns, map.rows, std::move(heights));
  };
  ground = through(ground_map, base.value_or(0.0));
  if (friction_raster) friction_map = through(*friction_raster, 0.0);
  if (const auto* const depths = std::get_if<io::Raster>(&release_map))
    release = std::make_shared<const Release>(*depths, west, north);
  else if (const auto* const regions = std::get_if<std::vector<io::Region>>(&release_map))
    release = std::make_shared<const Release>(*regions, release_depth.value_or(0.0), west, north);
}

}  // namespace repose::mpm
