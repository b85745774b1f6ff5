#include "report/page/scene_marks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "io/level_lines.hpp"
#include "io/thin_evenly.hpp"
#include "report/picture/scene_drawing.hpp"
#include "report/picture/terrain_picture.hpp"

namespace repose::report {
namespace {

using io::Json;
using Kind = mpm::Wall::Kind;

constexpr std::size_t most_places = 30'000;  ///< of all contours: about 400 kB of page

/// To four digits of the box: the page is sent by mail.
double rounded(const mpm::Scene& scene, double x) {
  const double step = 1e-4 * std::pow(10.0, std::floor(std::log10(scene.domain[0])));
  return std::round(x / step) * step;
}
Json place(const mpm::Scene& scene, double x, double y) {
  return Json{rounded(scene, x), rounded(scene, y)};
}

const char* word_of(Kind kind) {
  return kind == Kind::open       ? "open"
         : kind == Kind::periodic ? "periodic"
         : kind == Kind::inflow   ? "inflow"
                                  : "closed";
}

Json edges_of(const mpm::Scene& scene, const Section& section) {
  Json edges = Json::array();
  for (const EdgeStretch& stretch : edge_stretches(scene, section.middle()))
    edges.push_back({{"kind", word_of(stretch.kind)},
                     {"from", place(scene, stretch.from[0], stretch.from[1])},
                     {"to", place(scene, stretch.to[0], stretch.to[1])}});
  return edges;
}

Json surfaces_of(const mpm::Scene& scene, const Section& section, std::span<const double> times) {
  Json surfaces = Json::array();
  for (const mpm::Surface& surface : scene.surfaces) {
    Json outlines = Json::array();
    for (const double time : times) {
      Json rings = Json::array();
      for (const mpm::Outline& outline :
           surface.outlines(time, section.middle(), {0.0, 0.0}, {scene.domain[0], scene.domain[1]}))
        for (const mpm::Polygon& ring : outline) {
          Json corners = Json::array();
          for (const auto& [x, y] : ring.corners) corners.push_back(place(scene, x, y));
          rings.push_back(std::move(corners));
        }
      outlines.push_back(std::move(rings));
      if (!surface.moves()) break;
    }
    surfaces.push_back({{"name", surface.name},
                        {"hollow", surface.solid.hollow},
                        {"outlines", std::move(outlines)}});
  }
  return surfaces;
}

/// Contours of the ground and the outline of the release.
Json lines_of(const mpm::Scene& scene) {
  const mpm::Terrain& terrain = *scene.terrain;
  const io::Raster& ground = terrain.ground_map;
  std::vector<std::pair<const char*, io::LevelLine>> lines;
  std::size_t places = 0;
  for (const double level : contour_levels(terrain))
    for (io::LevelLine& line : io::level_lines(middles(ground), level)) {
      places += line.places.size();
      lines.emplace_back("contour", std::move(line));
    }
  const std::size_t stride = places / most_places + 1;
  for (const io::Region& region : released(terrain)) {
    lines.emplace_back("release", io::LevelLine{region.outer, true});
    for (const io::Ring& hole : region.holes)
      lines.emplace_back("release", io::LevelLine{hole, true});
  }
  Json all = Json::array();
  for (const auto& [kind, line] : lines) {
    Json drawn = Json::array();
    const std::size_t count = line.places.size() / (kind[0] == 'c' ? stride : 1);
    for (const std::size_t k : io::thin_evenly(line.places.size(), std::max<std::size_t>(count, 4)))
      drawn.push_back(
          place(scene, line.places[k][0] - ground.west, line.places[k][1] - ground.south));
    if (line.closed && !drawn.empty()) drawn.push_back(drawn[0]);
    all.push_back({{"kind", kind}, {"places", std::move(drawn)}});
  }
  return all;
}

/// The box's sides from above: left, right, near to the north and far to the south.
Json sides_of(const mpm::Scene& scene) {
  const double top = plan_height(scene), right = scene.domain[0], bottom = top - scene.domain[2];
  Json edges = Json::array();
  const auto add = [&](std::size_t edge, double x0, double y0, double x1, double y1) {
    edges.push_back({{"kind", word_of(scene.edge(edge).kind)},
                     {"from", place(scene, x0, y0)},
                     {"to", place(scene, x1, y1)}});
  };
  add(0, 0.0, bottom, 0.0, top);
  add(1, right, bottom, right, top);
  add(4, 0.0, top, right, top);
  add(5, 0.0, bottom, right, bottom);
  return edges;
}

}  // namespace

double plan_height(const mpm::Scene& scene) {
  return scene.terrain ? scene.terrain->ground_map.height() : 0.0;
}

Json scene_marks(const mpm::Scene& scene, std::span<const double> times) {
  const Section section = section_of(scene);
  const bool plan = scene.terrain.has_value();
  Json marks;
  marks["plan"] = plan;
  marks["plan_height"] = plan_height(scene);
  marks["bodies"] = Json::array();
  for (std::size_t body = 0; body < scene.bodies.size(); ++body)
    marks["bodies"].push_back(name_of(scene, body));
  marks["edges"] = plan ? sides_of(scene) : edges_of(scene, section);
  marks["surfaces"] = plan ? Json::array() : surfaces_of(scene, section, times);
  marks["probes"] = Json::array();
  for (const mpm::Probe& probe : plan ? from_above(*scene.terrain, scene.probes) : scene.probes)
    marks["probes"].push_back(
        {{"name", probe.name}, {"place", place(scene, probe.place[0], probe.place[1])}});
  marks["tracers"] = Json::array();
  for (const mpm::Probe& tracer : scene.tracers) marks["tracers"].push_back(tracer.name);
  marks["lines"] = plan ? lines_of(scene) : Json::array();
  return marks;
}

}  // namespace repose::report
