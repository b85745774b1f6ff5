#include "report/picture/terrain_picture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "io/level_lines.hpp"
#include "report/picture/scene_drawing.hpp"
#include "report/plot/figure.hpp"
#include "study/run/terrain_result.hpp"

namespace repose::report {
namespace {

constexpr std::size_t most_shades = 250'000;  ///< cells of the shaded picture

/// 1, 2 or 5 times a power of ten, at least x.
double round_step(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * power >= x) return step * power;
  return 10.0 * power;
}

/// The ground as the sun would shade it from the north-west at 45° (Horn 1981), lightened so that
/// what lies upon it stands out.
void add_shade(Axes& axes, const mpm::Terrain& terrain) {
  const io::Raster& map = terrain.ground_map;
  const std::size_t stride = static_cast<std::size_t>(std::ceil(
      std::sqrt(static_cast<double>(map.columns * map.rows) / static_cast<double>(most_shades))));
  const double sun = std::numbers::inv_sqrt3;  // from the west, above and north alike
  std::vector<double> xs, ys, greys;
  for (std::size_t row = 0; row < map.rows; row += stride)
    for (std::size_t column = 0; column < map.columns; column += stride) {
      const double x = map.cell * (static_cast<double>(column) + 0.5);
      const double z = map.cell * (static_cast<double>(row) + 0.5);
      const auto [slope_x, slope_z] = terrain.ground->at(x, z).gradient;
      // normal (−∂y/∂x, 1, −∂y/∂z) and the direction to the sun (−1, 1, −1)/√3; z is south
      const double cosine = sun * (slope_x + 1.0 + slope_z) / std::hypot(1.0, slope_x, slope_z);
      xs.push_back(x);
      ys.push_back(map.height() - z);
      greys.push_back(0.45 + 0.55 * std::max(0.0, cosine));
    }
  axes.shade(xs, ys, greys);
}

/// Places of the map count from its lower left corner: six digits in front of every tick say
/// nothing.
void add_ring(Axes& axes, const std::string& name, const io::Raster& map, const io::Ring& ring,
              bool closed, const Style& style, bool dashed = false) {
  std::vector<double> xs, ys;
  for (std::size_t k = 0; k < ring.size() + (closed ? 1 : 0); ++k) {
    xs.push_back(ring[k % ring.size()][0] - map.west);
    ys.push_back(ring[k % ring.size()][1] - map.south);
  }
  if (dashed)
    axes.dashed(name, xs, ys, style);
  else
    axes.line(name, xs, ys, style);
}

/// The name stands in the legend once.
void add_regions(Axes& axes, std::string name, const io::Raster& map,
                 const std::vector<io::Region>& regions, const Style& style, bool dashed = false) {
  for (const io::Region& region : regions) {
    add_ring(axes, std::exchange(name, ""), map, region.outer, true, style, dashed);
    for (const io::Ring& hole : region.holes) add_ring(axes, "", map, hole, true, style, dashed);
  }
}

}  // namespace

io::Lattice middles(const io::Raster& map) {
  return {map.columns, map.rows,  map.west + 0.5 * map.cell, map.north() - 0.5 * map.cell, map.cell,
          -map.cell,   map.values};
}

std::vector<io::Region> released(const mpm::Terrain& terrain) {
  if (const auto* const regions = std::get_if<std::vector<io::Region>>(&terrain.release_map))
    return *regions;
  if (const auto* const depths = std::get_if<io::Raster>(&terrain.release_map)) {
    const double most = *std::max_element(depths->values.begin(), depths->values.end());
    return io::regions_above(middles(*depths), 0.02 * most);
  }
  return {};
}

double contour_step(const mpm::Terrain& terrain) {
  const auto [lowest, highest] =
      std::minmax_element(terrain.ground_map.values.begin(), terrain.ground_map.values.end());
  return *highest > *lowest ? round_step((*highest - *lowest) / 25.0) : 0.0;
}

std::vector<double> contour_levels(const mpm::Terrain& terrain) {
  const auto [lowest, highest] =
      std::minmax_element(terrain.ground_map.values.begin(), terrain.ground_map.values.end());
  const double step = contour_step(terrain);
  std::vector<double> levels;
  if (step > 0.0)
    for (double level = step * std::ceil(*lowest / step); level <= *highest; level += step)
      levels.push_back(level);
  return levels;
}

void size_for_plan(Figure& figure, const mpm::Terrain& terrain) {
  constexpr double largest_side_px = 760.0, other_side_px = 420.0;
  const bool wide = terrain.ground_map.width() >= terrain.ground_map.height();
  figure.columns = wide ? 1 : 2;
  figure.panel_width_px = wide ? largest_side_px : other_side_px;
  figure.panel_height_px = wide ? other_side_px : largest_side_px;
}

Axes& add_plan(Figure& figure, const mpm::Terrain& terrain) {
  const io::Raster& ground = terrain.ground_map;
  Axes& axes = figure.add_axes();
  axes.equal_aspect = true;
  axes.legend = Legend::top_right;
  const auto label = [](const char* towards, double from) {
    return from == 0.0 ? fmt::format("{} (m)", towards)
                       : fmt::format("{} − {:.10g} (m)", towards, from);
  };
  axes.x = {.label = label("easting", ground.west), .lower = 0.0, .upper = ground.width()};
  axes.y = {.label = label("northing", ground.south), .lower = 0.0, .upper = ground.height()};
  add_shade(axes, terrain);
  Style contour;
  contour.colour = Colour::grey;
  contour.width_px = 0.6;
  for (const double level : contour_levels(terrain))
    for (const io::LevelLine& line : io::level_lines(middles(ground), level))
      add_ring(axes, "", ground, line.places, line.closed, contour);
  return axes;
}

std::vector<mpm::Probe> from_above(const mpm::Terrain& terrain, std::vector<mpm::Probe> places) {
  for (mpm::Probe& at : places)
    at.place = {at.place[0], terrain.ground_map.height() - at.place[2], 0.0};
  return places;
}

void draw_release(Axes& axes, const mpm::Terrain& terrain) {
  Style edge;
  edge.width_px = 1.6;
  edge.colour = Colour::black;
  add_regions(axes, "released", terrain.ground_map, released(terrain), edge, true);
}

void draw_terrain_picture(const mpm::Simulation& simulation, const std::filesystem::path& path) {
  const mpm::Scene& scene = simulation.scene();
  const mpm::Terrain& terrain = *scene.terrain;
  const io::Raster& ground = terrain.ground_map;
  const study::TerrainMaps maps = study::terrain_maps(simulation);
  const mpm::Simulation::PlanMaps plan = simulation.plan_maps();
  const double step = contour_step(terrain);

  Figure figure(fmt::format("{} at {:.4g} s", scene.name, simulation.time()),
                step > 0.0
                    ? fmt::format("contours of the ground every {:g} m; depths from {:.3g} m "
                                  "on are shown",
                                  step, plan.least_depth)
                    : "");
  size_for_plan(figure, terrain);

  const std::vector<io::Region> reached = io::regions_above(
      {plan.columns, plan.rows, ground.west, ground.north(), plan.h, -plan.h, plan.depth_max_m},
      plan.least_depth);
  for (const bool last : {false, true}) {
    const io::Raster& depths = last ? maps.deposit_m : maps.largest_depth_m;
    Axes& axes = add_plan(figure, terrain);
    axes.title = last ? "deposit" : "largest depth";
    std::vector<double> xs, ys, values;
    for (std::size_t row = 0; row < depths.rows; ++row)
      for (std::size_t column = 0; column < depths.columns; ++column) {
        if (!(depths.at(row, column) >= plan.least_depth)) continue;
        xs.push_back(ground.cell * (static_cast<double>(column) + 0.5));
        ys.push_back(ground.height() - ground.cell * (static_cast<double>(row) + 0.5));
        values.push_back(depths.at(row, column));
      }
    ScatterStyle cells;
    cells.diameter = 1.5 * ground.cell;  // discs that leave no gap between cells
    if (!values.empty()) axes.scatter(xs, ys, values, {.label = "solid depth (m)"}, cells);
    Style edge;
    edge.width_px = 1.6;
    edge.colour = Colour::vermillion;
    add_regions(axes, "reached", ground, reached, edge);
    draw_release(axes, terrain);
    draw_places(axes, from_above(terrain, scene.probes), false);
    draw_places(axes, from_above(terrain, section_of(simulation).tracers), true);
  }
  figure.render_svg(path);
}

}  // namespace repose::report
