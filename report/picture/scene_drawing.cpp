#include "report/picture/scene_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/core.h>

namespace repose::report {

namespace {

using Place = std::array<double, 2>;
using Kind = mpm::Wall::Kind;

constexpr double largest_width_px = 860.0, largest_height_px = 560.0;  // of the box on paper
constexpr double arrow_px = 56.0;
constexpr double outline_px = 1.6;
constexpr std::size_t most_named =
    12;  // of bodies, and of probes: a legend no taller than the panel

double wall_of(const mpm::Scene& scene) {
  return 0.012 * std::max(scene.domain[0], scene.domain[1]);
}

double metres_per_px(const mpm::Scene& scene) {
  const double walls = 2.0 * wall_of(scene);
  return std::max((scene.domain[0] + walls) / largest_width_px,
                  (scene.domain[1] + walls) / largest_height_px);
}

Style drawn_in(Colour colour, double width_px) {
  Style style;
  style.colour = colour;
  style.width_px = width_px;
  return style;
}

bool is_closed(Kind kind) {
  return kind != Kind::open && kind != Kind::periodic && kind != Kind::inflow;
}

/// Of the inflows of an edge those that a section at z shows.
std::vector<const mpm::Inflow*> inflows_of(const mpm::Scene& scene, std::size_t edge, double z) {
  std::vector<const mpm::Inflow*> found;
  for (const mpm::Inflow& inflow : scene.inflows) {
    const mpm::Stretch stretch = stretch_of(scene, inflow);
    if (inflow.edge == edge && z >= stretch.from[1] && z < stretch.to[1]) found.push_back(&inflow);
  }
  return found;
}

/// What an edge is at a place along it.
Kind kind_at(const mpm::Scene& scene, std::size_t edge, double along, double z) {
  for (const mpm::Inflow* const inflow : inflows_of(scene, edge, z)) {
    const mpm::Stretch stretch = stretch_of(scene, *inflow);
    if (along >= stretch.from[0] && along < stretch.to[0]) return Kind::inflow;
  }
  const mpm::Wall& wall = scene.edge(edge);
  if (wall.kind != Kind::parts) return wall.kind;
  const auto part =
      std::find_if(wall.parts.begin(), wall.parts.end(), [&](const mpm::Wall::Part& p) {
        return along >= p.from[0] && along < p.to[0] && z >= p.from[1] && z < p.to[1];
      });
  return part == wall.parts.end() ? Kind::no_slip : part->kind;
}

/// A place on an edge.
Place on_edge(const mpm::Scene& scene, std::size_t edge, double along) {
  const double across = edge % 2 == 0 ? 0.0 : scene.domain[edge / 2];
  return edge < 2 ? Place{across, along} : Place{along, across};
}

void draw_edges(Axes& axes, const mpm::Scene& scene, const Section& section) {
  const double wall = wall_of(scene);
  const Style solid = drawn_in(Colour::grey, 1.0), inner = drawn_in(Colour::black, outline_px);
  std::string open = section.explained ? "open edge" : "",
              periodic = section.explained ? "periodic edge" : "";
  for (const EdgeStretch& stretch : edge_stretches(scene, section.middle())) {
    const std::array xs{stretch.from[0], stretch.to[0]}, ys{stretch.from[1], stretch.to[1]};
    if (stretch.kind == Kind::open) {
      axes.dashed(std::exchange(open, ""), xs, ys, inner);
      continue;
    }
    if (stretch.kind == Kind::periodic) {
      axes.dashed(std::exchange(periodic, ""), xs, ys, drawn_in(Colour::grey, outline_px));
      continue;
    }
    if (stretch.kind == Kind::inflow) continue;
    // the wall's thickness lies outside of the box and fills its corners
    const double outwards = stretch.edge % 2 == 0 ? -wall : wall;
    if (stretch.edge < 2) {
      const std::array across{std::min(xs[0], xs[0] + outwards), std::max(xs[0], xs[0] + outwards)};
      axes.band("", across, std::array{ys[0], ys[0]}, std::array{ys[1], ys[1]}, solid);
    } else {
      const std::array along{xs[0] == 0.0 ? -wall : xs[0],
                             xs[1] == scene.domain[0] ? xs[1] + wall : xs[1]};
      const double low = std::min(ys[0], ys[0] + outwards),
                   high = std::max(ys[0], ys[0] + outwards);
      axes.band("", along, std::array{low, low}, std::array{high, high}, solid);
    }
    axes.line("", xs, ys, inner);
  }
}

void draw_inflows(Axes& axes, const mpm::Scene& scene, const Section& section) {
  for (std::size_t edge = 0; edge < 4; ++edge)
    for (const mpm::Inflow* const inflow : inflows_of(scene, edge, section.middle())) {
      const mpm::Stretch stretch = stretch_of(scene, *inflow);
      Place inwards{};
      inwards[edge / 2] = edge % 2 == 0 ? 1.0 : -1.0;
      draw_inflow(axes, scene, *inflow, on_edge(scene, edge, stretch.from[0]),
                  on_edge(scene, edge, stretch.to[0]), inwards, arrow_px * metres_per_px(scene),
                  section.explained);
    }
}

/// What moves as one, and where its arrow starts.
struct Motion {
  std::string name;
  Place centre{};
  double radius = 0.0;  ///< of its farthest place from the pivot [m]
  Place velocity{};     ///< [m/s]
  double spin = 0.0;    ///< [rad/s]
  Place pivot{};
  double starts = 0.0, stops = HUGE_VAL;  ///< [s]
};

/// A straight arrow along the velocity of the centre, or where that hardly moves a piece of the
/// circle that its parts go on.
void draw_motion(Axes& axes, const mpm::Scene& scene, const Motion& motion) {
  const Place velocity{motion.velocity[0] - motion.spin * (motion.centre[1] - motion.pivot[1]),
                       motion.velocity[1] + motion.spin * (motion.centre[0] - motion.pivot[0])};
  const double speed = std::hypot(velocity[0], velocity[1]);
  const double turning = std::abs(motion.spin) * motion.radius;
  if (speed == 0.0 && turning == 0.0) return;
  std::string text = motion.name;
  if (motion.velocity != Place{})
    text += fmt::format(" {:.3g} m/s", std::hypot(motion.velocity[0], motion.velocity[1]));
  if (motion.spin != 0.0) text += fmt::format(" {:.3g} rad/s", motion.spin);
  if (motion.starts > 0.0) text += fmt::format(" from {:g} s", motion.starts);
  if (motion.stops < HUGE_VAL) text += fmt::format(" until {:g} s", motion.stops);
  const double length = arrow_px * metres_per_px(scene);
  if (speed > 0.25 * turning) {
    const Place tip{motion.centre[0] + length * velocity[0] / speed,
                    motion.centre[1] + length * velocity[1] / speed};
    axes.arrow({motion.centre[0], motion.centre[1], tip[0], tip[1], ""});
    axes.label({tip[0], tip[1], text});
    return;
  }
  const double radius = 0.6 * motion.radius;
  std::vector<double> xs, ys;
  constexpr int places = 24;
  for (int k = 0; k <= places; ++k) {  // 60° about the upright
    const double turned = std::numbers::pi / 3.0 * (static_cast<double>(k) / places - 0.5);
    const double angle = 0.5 * std::numbers::pi + (motion.spin > 0.0 ? turned : -turned);
    xs.push_back(motion.pivot[0] + radius * std::cos(angle));
    ys.push_back(motion.pivot[1] + radius * std::sin(angle));
  }
  axes.line("", xs, ys, drawn_in(Colour::black, outline_px));
  const auto last = static_cast<std::size_t>(places);
  axes.arrow({xs[last - 2], ys[last - 2], xs[last], ys[last], ""});
  axes.label({motion.pivot[0], motion.pivot[1] + radius + 0.25 * length, text});
}

double farthest(const mpm::Polygon& outline, const Place& from) {
  double distance = 0.0;
  for (const Place& corner : outline.corners)
    distance = std::max(distance, std::hypot(corner[0] - from[0], corner[1] - from[1]));
  return distance;
}

/// One line around an outline and its holes: what two of them surround is not in it.
mpm::Polygon joined(const mpm::Outline& outline) {
  if (outline.size() == 1) return outline.front();
  mpm::Polygon line;
  for (const mpm::Polygon& ring : outline) {
    line.corners.insert(line.corners.end(), ring.corners.begin(), ring.corners.end());
    line.corners.push_back(ring.corners.front());
  }
  return line;
}

/// Corners of the rectangle around a body.
std::pair<Place, Place> around(const mpm::Body& body) {
  return {{body.origin[0], body.origin[1]},
          {body.origin[0] + body.size[0], body.origin[1] + body.size[1]}};
}

/// Of a body that other shapes cut, from the distances of them all.
std::vector<mpm::Polygon> cut_outlines(const mpm::Body& body, double z) {
  mpm::Body uncut = body;
  uncut.within.clear();
  uncut.without.clear();
  const std::vector<mpm::Polygon> whole = outlines_of(uncut, z);
  const auto distance = [&](double x, double y) {
    double out = HUGE_VAL;
    for (const mpm::Polygon& part : whole)
      out = std::min(out, mpm::nearest({part, false}, {x, y, z}).distance);
    for (const mpm::Solid& solid : body.within)
      out = std::max(out, nearest(solid, {x, y, z}).distance);
    for (const mpm::Solid& solid : body.without)
      out = std::max(out, -nearest(solid, {x, y, z}).distance);
    return out;
  };
  const auto [low, high] = around(body);
  std::vector<mpm::Polygon> found;
  if (whole.empty()) return found;
  for (const mpm::Outline& outline : mpm::outlines_of(distance, low, high))
    found.push_back(joined(outline));
  return found;
}

/// x and y of its corners, and of the first again.
std::pair<std::vector<double>, std::vector<double>> closed_line(const mpm::Polygon& polygon) {
  std::vector<double> xs, ys;
  for (std::size_t k = 0; k <= polygon.corners.size(); ++k) {
    xs.push_back(polygon.corners[k % polygon.corners.size()][0]);
    ys.push_back(polygon.corners[k % polygon.corners.size()][1]);
  }
  return {xs, ys};
}

void draw_surfaces(Axes& axes, const mpm::Scene& scene, const Section& section) {
  std::vector<std::string> names;
  for (const mpm::Surface& surface : scene.surfaces)
    if (!surface.name.empty()) names.push_back(surface.name);
  std::string legend;
  if (section.explained) {
    legend = "rigid";
    for (std::size_t k = 0; k < names.size(); ++k) legend += (k == 0 ? ": " : ", ") + names[k];
  }
  for (const mpm::Surface& surface : scene.surfaces) {
    const std::vector<mpm::Outline> outlines = surface.outlines(
        section.time_s, section.middle(), {0.0, 0.0}, {scene.domain[0], scene.domain[1]});
    const mpm::Polygon* largest = nullptr;
    for (const mpm::Outline& outline : outlines) {
      if (!surface.solid.hollow) {
        const auto [xs, ys] = closed_line(joined(outline));
        axes.area("", xs, ys, drawn_in(Colour::grey, 1.0));
      }
      for (const mpm::Polygon& ring : outline) {
        const auto [xs, ys] = closed_line(ring);
        axes.line(std::exchange(legend, ""), xs, ys, drawn_in(Colour::black, outline_px));
      }
      if (largest == nullptr || mpm::piece_of(outline.front()).area > mpm::piece_of(*largest).area)
        largest = &outline.front();
    }
    if (section.explained && surface.moves() && largest != nullptr)
      draw_motion(axes, scene,
                  {surface.name,
                   mpm::piece_of(*largest).centroid,
                   farthest(*largest, surface.pivot),
                   {surface.velocity[0], surface.velocity[1]},
                   surface.spin,
                   surface.pivot,
                   surface.starts,
                   surface.stops});
  }
}

/// Of bodies at the start.
void draw_motions(Axes& axes, const mpm::Scene& scene, const Section& section) {
  if (!scene.start_from.empty()) return;
  for (const mpm::Body& body : scene.bodies) {
    const Place centre{body.origin[0] + 0.5 * body.size[0], body.origin[1] + 0.5 * body.size[1]};
    for (const mpm::Polygon& outline : outlines_of(body, section.middle())) {
      draw_motion(axes, scene,
                  {body.name,
                   centre,
                   farthest(outline, centre),
                   {body.velocity[0], body.velocity[1]},
                   body.spin,
                   centre});
      break;  // one arrow, of an upright ring too
    }
  }
  // edges that move along themselves
  for (std::size_t edge = 0; edge < 4; ++edge) {
    const mpm::Wall& wall = scene.edge(edge);
    if (wall.kind != Kind::no_slip || wall.speed == 0.0) continue;
    Place velocity{};
    velocity[1 - edge / 2] = wall.speed;
    draw_motion(axes, scene,
                {std::string(mpm::edge_names[edge]),
                 on_edge(scene, edge, 0.5 * scene.domain[1 - edge / 2]), 0.0, velocity});
  }
}

void draw_gravity(Axes& axes, const mpm::Scene& scene) {
  if (!(scene.gravity > 0.0)) return;
  const double angle = scene.tilt_deg * std::numbers::pi / 180.0;
  const double length = std::min(60.0 * metres_per_px(scene), 0.6 * scene.domain[1]);
  const double x = scene.domain[0] - length * (0.35 + std::max(0.0, std::sin(angle)));
  const double y = scene.domain[1] - 0.25 * length;
  axes.arrow(
      {x, y, x + length * std::sin(angle), y - length * std::cos(angle),
       scene.tilt_deg == 0.0 ? "gravity" : fmt::format("gravity, tilt {:g}°", scene.tilt_deg)});
}

}  // namespace

std::string Section::title() const {
  return depth_m > 0.0 ? fmt::format(", z = {:.4g} to {:.4g} m", z_m, z_m + depth_m) : "";
}

Section section_of(const mpm::Scene& scene) {
  Section section;
  if (scene.dimensions() == 3) {
    section.z_m = scene.near.kind == Kind::slip ? 0.0 : 0.5 * scene.domain[2];
    section.depth_m = scene.h;
  }
  section.tracers = scene.tracers;
  return section;
}

Section section_of(const mpm::Simulation& simulation) {
  const mpm::Scene& scene = simulation.scene();
  Section section = section_of(scene);
  section.time_s = simulation.time();
  section.tracers.clear();
  for (std::size_t k = 0; k < scene.tracers.size(); ++k)
    if (const mpm::Simulation::Sight sight = simulation.tracer(k); sight.mass > 0.0)
      section.tracers.push_back({scene.tracers[k].name, sight.position});
  return section;
}

std::vector<EdgeStretch> edge_stretches(const mpm::Scene& scene, double z) {
  std::vector<EdgeStretch> found;
  for (std::size_t edge = 0; edge < 4; ++edge) {
    const double length = scene.domain[1 - edge / 2];
    std::vector<double> ends{0.0, length};
    const auto add = [&](const std::array<double, 2>& from, const std::array<double, 2>& to) {
      for (const double end : {from[0], to[0]})
        if (end > 0.0 && end < length) ends.push_back(end);
    };
    if (scene.edge(edge).kind == Kind::parts)
      for (const mpm::Wall::Part& part : scene.edge(edge).parts) add(part.from, part.to);
    for (const mpm::Inflow* const inflow : inflows_of(scene, edge, z))
      add(inflow->from, inflow->to);
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    const std::size_t first = found.size();
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      const Kind kind = kind_at(scene, edge, 0.5 * (ends[k] + ends[k + 1]), z);
      const Place to = on_edge(scene, edge, ends[k + 1]);
      if (found.size() > first &&
          (found.back().kind == kind || (is_closed(found.back().kind) && is_closed(kind))))
        found.back().to = to;
      else
        found.push_back({edge, kind, on_edge(scene, edge, ends[k]), to});
    }
  }
  return found;
}

std::vector<mpm::Polygon> outlines_of(const mpm::Body& body, double z) {
  if (!body.within.empty() || !body.without.empty()) return cut_outlines(body, z);
  if (body.polygon) return {*body.polygon};
  if (body.solid) {
    mpm::Surface alike;
    alike.solid = *body.solid;
    const auto [low, high] = around(body);
    std::vector<mpm::Polygon> found;
    for (const mpm::Outline& outline : alike.outlines(0.0, z, low, high))
      found.push_back(joined(outline));
    return found;
  }
  const auto rectangle = [&](double from, double to) {
    const double low = body.origin[1], high = low + body.size[1];
    return mpm::Polygon{{{from, low}, {to, low}, {to, high}, {from, high}}};
  };
  const double left = body.origin[0], right = left + body.size[0];
  const bool space = body.size[2] > 0.0;
  if (space && (z < body.origin[2] || z > body.origin[2] + body.size[2])) return {};
  if (!body.disc) return {rectangle(left, right)};
  const mpm::Disc& disc = *body.disc;
  if (!space) {
    mpm::Polygon ring;
    constexpr int corners = 120;
    const auto add = [&](double radius, double sense) {
      for (int k = 0; k <= corners && radius > 0.0; ++k) {
        const double angle = sense * 2.0 * std::numbers::pi * k / corners;
        ring.corners.push_back(
            {disc.centre[0] + radius * std::cos(angle), disc.centre[1] + radius * std::sin(angle)});
      }
    };
    add(disc.radius, 1.0);
    add(disc.hole, -1.0);  // what both surround is not in it
    return {ring};
  }
  // half the chord that a plane at z cuts from an upright cylinder
  const auto half_chord = [&](double radius) {
    const double dz = z - disc.centre[1];
    return std::sqrt(std::max(0.0, radius * radius - dz * dz));
  };
  const double outer = half_chord(disc.radius), inner = half_chord(disc.hole);
  std::vector<mpm::Polygon> pieces;
  for (const auto& [from, to] : {std::pair{-outer, -inner}, std::pair{inner, outer}}) {
    const double low = std::max(left, disc.centre[0] + from),
                 high = std::min(right, disc.centre[0] + to);
    if (!(high > low)) continue;
    if (!pieces.empty() && inner == 0.0)
      pieces.back() = rectangle(pieces.back().corners[0][0], high);
    else
      pieces.push_back(rectangle(low, high));
  }
  return pieces;
}

std::string name_of(const mpm::Scene& scene, std::size_t body) {
  const mpm::Body& of = scene.bodies[body];
  return fmt::format("{} ({})", of.name, of.law.name);
}

Colour colour_of_body(std::size_t body) {
  // vermillion is for what is looked at, black and grey for what is rigid
  constexpr std::array order{Colour::blue, Colour::orange, Colour::green, Colour::purple,
                             Colour::sky};
  return order[body % order.size()];
}

std::string legend_name_of(const mpm::Scene& scene, std::size_t body) {
  if (body < most_named) return name_of(scene, body);
  return body == most_named ? fmt::format("and {} more", scene.bodies.size() - most_named) : "";
}

void draw_bodies(Axes& axes, const mpm::Scene& scene, std::span<const std::int32_t> body,
                 std::span<const double> xs, std::span<const double> ys, double diameter) {
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    Style style;
    style.colour = colour_of_body(k);
    style.diameter = diameter;
    std::vector<double> x, y;
    for (std::size_t i = 0; i < body.size(); ++i)
      if (static_cast<std::size_t>(body[i]) == k) {
        x.push_back(xs[i]);
        y.push_back(ys[i]);
      }
    axes.points(legend_name_of(scene, k), x, y, style);
  }
}

Axes& add_section(Figure& figure, const mpm::Scene& scene) {
  figure.panel_width_px = largest_width_px;
  figure.panel_height_px = largest_height_px;
  Axes& axes = figure.add_axes();
  axes.equal_aspect = true;
  const double wall = wall_of(scene);
  axes.x = {.label = "x (m)", .lower = -wall, .upper = scene.domain[0] + wall};
  axes.y = {.label = "y (m)", .lower = -wall, .upper = scene.domain[1] + wall};
  return axes;
}

void draw_surroundings(Axes& axes, const mpm::Scene& scene, const Section& section) {
  draw_edges(axes, scene, section);
  draw_surfaces(axes, scene, section);
  draw_inflows(axes, scene, section);
  if (section.explained) draw_motions(axes, scene, section);
  const auto in_view = [&](std::vector<mpm::Probe> places) {
    for (mpm::Probe& probe : places)
      if (section.depth_m > 0.0 &&
          (probe.place[2] < section.z_m || probe.place[2] >= section.z_m + section.depth_m))
        probe.name += fmt::format(" (z = {:.4g} m)", probe.place[2]);
    return places;
  };
  draw_places(axes, in_view(scene.probes), false);
  draw_places(axes, in_view(section.tracers), true);
  draw_gravity(axes, scene);
}

void draw_inflow(Axes& axes, const mpm::Scene& scene, const mpm::Inflow& inflow, const Place& from,
                 const Place& to, const Place& inwards, double length, bool explained) {
  const Colour colour = explained ? colour_of_body(inflow.body) : Colour::black;
  axes.line("", std::array{from[0], to[0]}, std::array{from[1], to[1]}, drawn_in(colour, 5.0));
  const Place middle{0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])};
  const Place tip{middle[0] + length * inwards[0], middle[1] + length * inwards[1]};
  axes.arrow({middle[0], middle[1], tip[0], tip[1], ""});
  std::string text = inflow.name.empty() ? "inflow" : inflow.name;
  text += inflow.speed
              ? fmt::format(" {:g} m/s", *inflow.speed)
              : fmt::format(" {:g} kg/s{}", *inflow.rate, scene.dimensions() == 3 ? "" : " per m");
  if (inflow.starts > 0.0) text += fmt::format(" from {:g} s", inflow.starts);
  if (inflow.stops < HUGE_VAL) text += fmt::format(" until {:g} s", inflow.stops);
  axes.label({tip[0], tip[1], text});
}

void draw_places(Axes& axes, const std::vector<mpm::Probe>& places, bool tracers) {
  Style style = drawn_in(Colour::vermillion, outline_px);
  style.marker = tracers ? Marker::ring : Marker::cross;
  style.marker_px = 11.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto& [x, y, z] = places[k].place;
    axes.label({x, y, tracers ? places[k].name : fmt::format("{}", k + 1)});
    std::string name;
    if (tracers && k == 0)
      name = "tracer";
    else if (!tracers && k < most_named)
      name = fmt::format("{}: {}", k + 1, places[k].name);
    else if (!tracers && k == most_named)
      name = fmt::format("{} to {}: more probes", k + 1, places.size());
    axes.points(name, std::array{x}, std::array{y}, style);
  }
}

}  // namespace repose::report
