#include "report/picture/scene_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/number_text.hpp"
#include "report/picture/scene_drawing.hpp"
#include "report/picture/terrain_picture.hpp"

namespace repose::report {
namespace {

/// "no_slip", "friction 0.4"
std::string edge_words(const mpm::Wall& wall) {
  switch (wall.kind) {
    case mpm::Wall::Kind::no_slip:
      return "no_slip";
    case mpm::Wall::Kind::slip:
      return "slip";
    case mpm::Wall::Kind::friction:
      return fmt::format("friction {:g}", wall.friction);
    case mpm::Wall::Kind::open:
      return "open";
    case mpm::Wall::Kind::periodic:
      return "periodic";
    case mpm::Wall::Kind::parts:
    case mpm::Wall::Kind::inflow:
      break;
  }
  return "in parts";
}

/// "left, right slip; floor no_slip": what the edges are, those that are alike together.
std::string edges_line(const mpm::Scene& scene) {
  std::vector<std::pair<std::string, std::string>> kinds;  // what they are, and which
  for (std::size_t edge = 0; edge < 2 * scene.dimensions(); ++edge) {
    const std::string words = edge_words(scene.edge(edge));
    const std::string name(mpm::edge_names[edge]);
    const auto same = std::find_if(kinds.begin(), kinds.end(),
                                   [&](const auto& kind) { return kind.first == words; });
    if (same == kinds.end())
      kinds.emplace_back(words, name);
    else
      same->second += ", " + name;
  }
  std::string line;
  for (const auto& [words, names] : kinds)
    line += fmt::format("{}{} {}", line.empty() ? "" : "; ", names, words);
  return line;
}

std::vector<std::int64_t> points_of(const mpm::Scene& scene,
                                    const mpm::Simulation::Snapshot* shot) {
  std::vector<std::int64_t> points(scene.bodies.size(), 0);
  if (shot != nullptr)
    for (const std::int32_t body : shot->body) ++points[static_cast<std::size_t>(body)];
  else
    for (std::size_t body = 0; body < points.size(); ++body)
      points[body] = std::llround(expected_points(scene, scene.bodies[body]));
  return points;
}

/// Points of the bodies, cells, first step; then the edges.
std::string subtitle_of(const mpm::Scene& scene, const mpm::Estimate& estimate,
                        const std::vector<std::int64_t>& points) {
  std::string line;
  constexpr std::size_t most_bodies = 6;
  if (points.size() > 1 && points.size() <= most_bodies) {
    for (std::size_t body = 0; body < points.size(); ++body)
      line += fmt::format("{}{} {}", body == 0 ? "points: " : ", ", scene.bodies[body].name,
                          io::grouped(static_cast<double>(points[body])));
  } else {
    line = fmt::format("{} points", io::grouped(static_cast<double>(estimate.points)));
    if (points.size() > 1) line += fmt::format(" in {} bodies", points.size());
  }
  line += "; cells: ";
  for (std::size_t k = 0; k < scene.dimensions(); ++k)
    line += fmt::format("{}{}", k > 0 ? " × " : "", std::lround(scene.domain[k] / scene.h));
  line += fmt::format(" of {:.4g} m; first step {:.3g} s", scene.h, estimate.first_dt_s);
  return line + "; edges: " + edges_line(scene);
}

using Place = std::array<double, 2>;

constexpr double apart = 0.75;  ///< of a spacing is a point's disc: neighbours are told apart

void draw_area(Axes& axes, std::string name, const std::vector<Place>& corners, Colour colour) {
  Style style;
  style.colour = colour;
  std::vector<double> xs, ys;
  for (const auto& [x, y] : corners) {
    xs.push_back(x);
    ys.push_back(y);
  }
  axes.area(std::move(name), xs, ys, style);
}

/// The shapes of bodies as the scene gives them, rigid surfaces aside.
void draw_shapes(Axes& axes, const mpm::Scene& scene, double z, bool named) {
  for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
    std::string name = named ? legend_name_of(scene, body) : "";
    for (const mpm::Polygon& outline : outlines_of(scene.bodies[body], z))
      draw_area(axes, std::exchange(name, ""), outline.corners, colour_of_body(body));
  }
}

Figure section_picture(const mpm::Scene& scene, const mpm::Estimate& estimate,
                       const mpm::Simulation* start) {
  Section section = start != nullptr ? section_of(*start) : section_of(scene);
  section.explained = true;
  mpm::Simulation::Snapshot all;
  if (start != nullptr) all = start->snapshot();
  Figure figure(fmt::format("{} before its first step{}", scene.name, section.title()),
                subtitle_of(scene, estimate, points_of(scene, start != nullptr ? &all : nullptr)));
  Axes& axes = add_section(figure, scene);
  axes.legend = Legend::right;
  // with points of another run the shapes say nothing
  if (scene.start_from.empty()) draw_shapes(axes, scene, section.middle(), start == nullptr);
  if (start != nullptr) {
    if (scene.dimensions() == 3) all = all.slice(section.z_m, section.z_m + section.depth_m);
    draw_bodies(axes, scene, all.body, all.x_m, all.y_m, apart * point_spacing(scene));
  }
  draw_surroundings(axes, scene, section);
  return figure;
}

Figure plan_picture(const mpm::Scene& scene, const mpm::Estimate& estimate,
                    const mpm::Simulation* start) {
  const mpm::Terrain& terrain = *scene.terrain;
  const double height = terrain.ground_map.height();
  const auto at = [&](double x, double z) { return std::array{x, height - z}; };
  mpm::Simulation::Snapshot all;
  if (start != nullptr) all = start->snapshot();
  std::string subtitle =
      subtitle_of(scene, estimate, points_of(scene, start != nullptr ? &all : nullptr));
  if (const double step = contour_step(terrain); step > 0.0)
    subtitle += fmt::format("; contours of the ground every {:g} m", step);
  std::string surfaces;
  for (const mpm::Surface& surface : scene.surfaces)
    surfaces += (surfaces.empty() ? "" : ", ") + (surface.name.empty() ? "one" : surface.name);
  if (!surfaces.empty()) subtitle += "; surfaces not drawn: " + surfaces;

  Figure figure(scene.name + " before its first step, from above", subtitle);
  size_for_plan(figure, terrain);
  Axes& axes = add_plan(figure, terrain);
  axes.legend = Legend::right;
  draw_release(axes, terrain);
  for (std::size_t body = 0; body < scene.bodies.size(); ++body) {
    const mpm::Body& of = scene.bodies[body];
    if (of.release || !scene.start_from.empty()) continue;
    const double x = of.origin[0], z = of.origin[2];
    draw_area(axes, start == nullptr ? legend_name_of(scene, body) : "",
              {at(x, z), at(x + of.size[0], z), at(x + of.size[0], z + of.size[2]),
               at(x, z + of.size[2])},
              colour_of_body(body));
  }
  if (start != nullptr) {
    for (double& z : all.z_m) z = height - z;
    draw_bodies(axes, scene, all.body, all.x_m, all.z_m, apart * point_spacing(scene));
  }
  // the box, whose sides are edges: left, right, near to the north and far to the south
  const double width = scene.domain[0], depth = scene.domain[2];
  const std::array<std::array<double, 2>, 4> corners{at(0.0, 0.0), at(width, 0.0), at(width, depth),
                                                     at(0.0, depth)};
  Style style;
  style.colour = Colour::black;
  style.width_px = 2.4;
  std::string open = "open edge", closed = "closed edge", parts = "edge in parts";
  for (const auto& [edge, from, to] :
       {std::array<std::size_t, 3>{0, 3, 0}, {1, 1, 2}, {4, 0, 1}, {5, 2, 3}}) {
    const std::array xs{corners[from][0], corners[to][0]}, ys{corners[from][1], corners[to][1]};
    const mpm::Wall::Kind kind = scene.edge(edge).kind;
    const Colour before = style.colour;
    if (kind == mpm::Wall::Kind::open || kind == mpm::Wall::Kind::periodic) {
      axes.dashed(std::exchange(open, ""), xs, ys, style);
    } else if (kind == mpm::Wall::Kind::parts) {
      style.colour = Colour::grey;
      axes.line(std::exchange(parts, ""), xs, ys, style);
    } else {
      axes.line(std::exchange(closed, ""), xs, ys, style);
    }
    style.colour = before;
  }
  for (const mpm::Inflow& inflow : scene.inflows) {
    if (inflow.edge / 2 == 1) continue;  // through the top: seen end on
    const mpm::Stretch stretch = stretch_of(scene, inflow);
    const bool along_z = inflow.edge < 2;
    const std::size_t k = along_z ? 1 : 0;
    const double across = inflow.edge % 2 == 0 ? 0.0 : along_z ? width : depth;
    const double inwards = inflow.edge % 2 == 0 ? 1.0 : -1.0;
    const auto place = [&](double along) {
      return along_z ? at(across, along) : at(along, across);
    };
    draw_inflow(axes, scene, inflow, place(stretch.from[k]), place(stretch.to[k]),
                along_z ? std::array{inwards, 0.0} : std::array{0.0, -inwards},
                0.07 * std::max(width, depth), true);
  }
  draw_places(axes, from_above(terrain, scene.probes), false);
  draw_places(axes, from_above(terrain, scene.tracers), true);
  return figure;
}

}  // namespace

Figure scene_picture(const mpm::Scene& scene, const mpm::Estimate& estimate,
                     const mpm::Simulation* start) {
  return scene.terrain ? plan_picture(scene, estimate, start)
                       : section_picture(scene, estimate, start);
}

}  // namespace repose::report
