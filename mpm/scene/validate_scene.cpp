#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "mpm/scene/fill.hpp"
#include "mpm/scene/scene_checks.hpp"

namespace repose::mpm {
namespace {

constexpr double max_points = 1e8;        ///< about 25 GB
constexpr double max_cells = 1e9;         ///< of the box: half a gigabyte of tables
constexpr double min_cells = 3;           ///< across the box
constexpr double min_periodic_cells = 5;  ///< no node is its own image
constexpr double max_frames = 1e6;
constexpr double max_rows = 1e7;
constexpr double max_order = 100;

/// The walls with their keys.
std::vector<std::pair<Wall, const char*>> walls_of(const Scene& scene) {
  std::vector<std::pair<Wall, const char*>> walls{{scene.floor, "domain.floor"},
                                                  {scene.left, "domain.left"},
                                                  {scene.right, "domain.right"},
                                                  {scene.top, "domain.top"}};
  if (scene.dimensions() == 3) {
    walls.emplace_back(scene.near, "domain.near");
    walls.emplace_back(scene.far, "domain.far");
  }
  return walls;
}

/// The n-th root of x for n cells or points along each axis.
double per_axis(const Scene& scene, double x) {
  return scene.dimensions() == 2 ? std::sqrt(x) : std::cbrt(x);
}

void check_periodic(const Scene& scene) {
  const auto periodic = [](const Wall& wall) { return wall.kind == Wall::Kind::periodic; };
  for (const auto& [wall, key] :
       {std::pair{scene.floor, "domain.floor"}, {scene.top, "domain.top"}})
    if (periodic(wall)) throw InputError(key, "only left and right can be periodic");
  if (periodic(scene.left) != periodic(scene.right))
    throw InputError(periodic(scene.left) ? "domain.right" : "domain.left",
                     "where one of left and right is periodic the other must be so too");
  const double cells = scene.domain[0] / scene.h;
  if (periodic(scene.left) && cells < min_periodic_cells - 0.5)
    throw InputError("grid.h", "a periodic box must be at least " + number(min_periodic_cells) +
                                   " cells wide, and this has " + number(std::round(cells)) +
                                   ": h <= " + number(scene.domain[0] / min_periodic_cells) + " m");
}

/// The axes along an edge, 0 to 2; `edge` of edge_names.
std::vector<std::size_t> axes_along(const Scene& scene, std::size_t edge) {
  std::vector<std::size_t> axes;
  for (std::size_t axis = 0; axis < scene.dimensions(); ++axis)
    if (axis != edge / 2) axes.push_back(axis);
  return axes;
}

std::string interval(double from, double to) {
  return "[" + number(from) + ", " + number(to) + "]";
}

/// An edge in parts, cut at all their ends into rectangles (in the plane, intervals), in each of
/// which one part holds.
class PartsOfEdge {
 public:
  PartsOfEdge(const Scene& scene, std::size_t edge)
      : scene_(scene),
        parts_(scene.edge(edge).parts),
        axes_(axes_along(scene, edge)),
        key_("domain." + std::string(edge_names[edge])) {
    for (std::size_t k = 0; k < 2; ++k) {
      const double length = k < axes_.size() ? scene.domain[axes_[k]] : 1.0;
      cuts_[k] = {0.0, length};
      for (const Wall::Part& part : parts_)
        for (const double end : {part.from[k], part.to[k]})
          if (end > 0.0 && end < length && k < axes_.size()) cuts_[k].push_back(end);
      std::sort(cuts_[k].begin(), cuts_[k].end());
    }
  }

  void check() const {
    if (parts_.empty()) throw InputError(key_, "an edge in parts has at least one");
    for (std::size_t i = 0; i < parts_.size(); ++i) check_part(i);
    std::vector<char> holds(parts_.size(), 0);
    each([&](std::size_t i, std::size_t j) {
      const std::size_t part = at(i, j);
      if (part == parts_.size())
        throw InputError(key_, "no part of the edge holds in " + words(i, j));
      holds[part] = 1;
    });
    for (std::size_t i = 0; i < parts_.size(); ++i)
      if (holds[i] == 0)
        throw InputError(key_of(i),
                         "this part never holds: it lies beyond the edge, or parts "
                         "before it hold wherever it is");
    for (std::size_t k = 0; k < axes_.size(); ++k) check_widths(k);
  }

 private:
  std::string key_of(std::size_t part) const { return key_ + "[" + std::to_string(part) + "]"; }

  void check_part(std::size_t i) const {
    const Wall::Part& part = parts_[i];
    const std::string key = key_of(i);
    if (part.kind == Wall::Kind::periodic)
      throw InputError(key + ".kind", "a part of an edge cannot be periodic");
    if (part.kind == Wall::Kind::parts || part.kind == Wall::Kind::inflow)
      throw InputError(key + ".kind", "a part of an edge is no_slip, slip, open or has friction");
    if (part.kind == Wall::Kind::friction)
      require(part.friction, not_negative, (key + ".friction").c_str(), "friction");
    require(part.speed, {}, (key + ".speed").c_str(), "speed");
    if (part.speed != 0.0 && part.kind != Wall::Kind::no_slip)
      throw InputError(key + ".speed",
                       "only a no-slip wall can drag the material along: leave out its speed");
    if (axes_.size() == 1 && (std::isfinite(part.from[1]) || std::isfinite(part.to[1])))
      throw InputError(key, "in the plane an edge has one direction: a number, not a pair");
    for (std::size_t k = 0; k < axes_.size(); ++k)
      if (!(part.from[k] < part.to[k]))
        throw InputError(key, "it would begin at " + number(part.from[k]) + " m and end at " +
                                  number(part.to[k]) + " m");
  }

  /// Narrower openings have no node that flows freely, and narrower bars no node that holds.
  void check_widths(std::size_t k) const {
    const std::size_t other = 1 - k;
    const std::size_t last = cuts_[k].size() - 2;
    for (std::size_t j = 0; j + 1 < cuts_[other].size(); ++j)
      for (std::size_t first = 0, i = 0; i <= last; ++i) {
        const auto is_open = [&](std::size_t n) {
          return parts_[k == 0 ? at(n, j) : at(j, n)].kind == Wall::Kind::open;
        };
        if (i < last && is_open(i) == is_open(i + 1)) continue;
        const double from = cuts_[k][first], to = cuts_[k][i + 1];
        const int ends = (first > 0 ? 1 : 0) + (i < last ? 1 : 0);
        const int least = ends == 0 ? 0 : is_open(i) ? ends + 1 : 1;
        if (to - from < (least - lattice_tolerance) * scene_.h)
          throw InputError(key_, std::string(is_open(i) ? "the opening " : "the closed part ") +
                                     interval(from, to) + " m is " +
                                     number((to - from) / scene_.h, 3) +
                                     " cells wide; it must be " + "at least " +
                                     std::to_string(least) + " (h = " + number(scene_.h) + " m)");
        first = i + 1;
      }
  }

  template <class F>
  void each(F&& f) const {
    for (std::size_t j = 0; j + 1 < cuts_[1].size(); ++j)
      for (std::size_t i = 0; i + 1 < cuts_[0].size(); ++i)
        if (cuts_[0][i] < cuts_[0][i + 1] && cuts_[1][j] < cuts_[1][j + 1]) f(i, j);
  }
  /// The part that holds in a rectangle; their number if none does.
  std::size_t at(std::size_t i, std::size_t j) const {
    const std::array middle{0.5 * (cuts_[0][i] + cuts_[0][i + 1]),
                            0.5 * (cuts_[1][j] + cuts_[1][j + 1])};
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      bool inside = true;
      for (std::size_t k = 0; k < axes_.size(); ++k)
        inside = inside && middle[k] > parts_[part].from[k] && middle[k] < parts_[part].to[k];
      if (inside) return part;
    }
    return parts_.size();
  }
  std::string words(std::size_t i, std::size_t j) const {
    std::string text;
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      const std::size_t n = k == 0 ? i : j;
      text += (k == 0 ? "" : ", ") + std::string(1, static_cast<char>('x' + axes_[k])) + " = " +
              interval(cuts_[k][n], cuts_[k][n + 1]);
    }
    return text + " m";
  }

  const Scene& scene_;
  const std::vector<Wall::Part>& parts_;
  std::vector<std::size_t> axes_;
  std::string key_;
  std::array<std::vector<double>, 2> cuts_;
};

void check_parts(const Scene& scene) {
  for (std::size_t edge = 0; edge < 2 * scene.dimensions(); ++edge) {
    const Wall& wall = scene.edge(edge);
    const std::string key = "domain." + std::string(edge_names[edge]);
    if (wall.kind == Wall::Kind::inflow)
      throw InputError(key, "what comes in is an inflow of the scene, not a kind of edge");
    if (wall.kind != Wall::Kind::parts) continue;
    PartsOfEdge(scene, edge).check();
    const std::string but = "an edge in parts does not go with ";
    if (scene.left.kind == Wall::Kind::periodic) throw InputError(key, but + "periodic edges yet");
    if (scene.transfer == Transfer::xpic || scene.transfer == Transfer::fmpm)
      throw InputError("step.transfer", but + "transfer = \"" +
                                            std::string(name_of(scene.transfer)) +
                                            "\" yet; any other transfer does");
    if (scene.viscosity == Viscosity::implicit_solve)
      throw InputError("step.viscosity", but + "viscosity = \"implicit\" yet");
    for (const Wall::Part& part : wall.parts)
      if (scene.dimensions() == 3 && part.speed != 0.0)
        throw InputError(key,
                         "a wall that moves is for plane strain only: this scene has three "
                         "dimensions");
  }
}

void check_numbers(const Scene& scene) {
  require(scene.end_time, not_negative, "scene.end_time", "end_time");
  require(scene.gravity, not_negative, "scene.gravity", "gravity");
  require(scene.tilt_deg, {-90.0, 90.0, false, false}, "scene.tilt_deg", "tilt_deg");
  for (std::size_t k = 0; k < scene.dimensions(); ++k)
    require(scene.domain[k], positive, "domain.size", "domain.size");
  for (const auto& [wall, key] : walls_of(scene)) {
    if (wall.kind == Wall::Kind::friction) require(wall.friction, not_negative, key, "friction");
    require(wall.speed, {}, key, "speed");
    if (wall.speed != 0.0 && wall.kind != Wall::Kind::no_slip)
      throw InputError(key, "only a no-slip wall can drag the material along: leave out its speed");
  }
  require(scene.h, positive, "grid.h", "h");
  const int edge = scene.points_per_cell > 0 ? points_per_edge(scene) : 0;
  const bool space = scene.dimensions() == 3;
  if (scene.points_per_cell > 100 || edge < 1 ||
      edge * edge * (space ? edge : 1) != scene.points_per_cell)
    throw InputError(
        "grid.points_per_cell",
        "points_per_cell = " + std::to_string(scene.points_per_cell) +
            (space ? " must be a cube number up to 64 in three dimensions: 1, 8, 27, 64"
                   : " must be a square number from 1 to 100: 1, 4, 9, 16, ..."));
  require(scene.order, {1.0, max_order, false, false}, "step.order", "order");
  require(scene.pressure_averaging, not_negative, "step.pressure_averaging", "pressure_averaging");
  require(scene.viscosity_tolerance, {0.0, 0.1, true, false}, "step.viscosity_tolerance",
          "viscosity_tolerance");
  require(scene.courant, courant_range, "step.courant", "courant");
  if (scene.dt) require(*scene.dt, positive, "step.dt", "dt");
  require(scene.frame_interval, not_negative, "output.frame_interval", "frame_interval");
  require(scene.series_interval, not_negative, "output.series_interval", "series_interval");
  const auto count_limit = [&](double interval, double most, const char* key, const char* what) {
    if (interval > 0.0 && scene.end_time / interval > most)
      throw InputError(key, "an interval of " + number(interval) + " s would write " +
                                number(scene.end_time / interval, 3) + " " + what +
                                "; it must be >= " + number(scene.end_time / most) + " s");
  };
  count_limit(scene.frame_interval, max_frames, "output.frame_interval", "frames");
  count_limit(scene.series_interval, max_rows, "output.series_interval", "rows");
}

/// h divides the box's width, and every body holds whole point spacings.
bool fits(const Scene& scene, double h, bool with_bodies) {
  if (!is_whole_multiple(scene.domain[0], h)) return false;
  const double spacing = h / points_per_edge(scene);
  return !with_bodies || std::all_of(scene.bodies.begin(), scene.bodies.end(), [&](const Body& b) {
    if (is_cut(b) || b.release) return true;
    return is_whole_multiple(b.size[0], spacing) && is_whole_multiple(b.size[1], spacing) &&
           (scene.dimensions() == 2 || is_whole_multiple(b.size[2], spacing));
  });
}

/// The fewest digits of h, up to its double, that fit and are as many cells.
std::string shortest(const Scene& scene, double h, bool with_bodies) {
  for (int digits = 1; digits < 17; ++digits) {
    const std::string text = number(h, digits);
    const double rounded = std::stod(text);
    const bool as_many = std::lround(scene.domain[0] / rounded) == std::lround(scene.domain[0] / h);
    if (as_many && fits(scene, rounded, with_bodies)) return text;
  }
  return number(h, 17);
}

/// "0.005 or 0.00625": cell sizes within a factor 2 of h that fit, below and above it, short
/// decimals first; "" if there is none.
std::string nearby_h(const Scene& scene, bool with_bodies) {
  std::string below, above;
  const auto better = [&](const std::string& text, const std::string& than, double h) {
    if (than.empty()) return true;
    const bool short_text = text.size() <= 8, short_than = than.size() <= 8;
    if (short_text != short_than) return short_text;
    return std::abs(std::stod(text) - h) < std::abs(std::stod(than) - h);
  };
  const auto lowest = static_cast<std::int64_t>(std::max(1.0, scene.domain[0] / (2.0 * scene.h)));
  const auto highest = static_cast<std::int64_t>(std::min(2.0 * scene.domain[0] / scene.h, 1e5));
  for (std::int64_t n = lowest; n <= highest; ++n) {
    const double h = scene.domain[0] / static_cast<double>(n);
    if (!fits(scene, h, with_bodies)) continue;
    const std::string text = shortest(scene, h, with_bodies);
    std::string& best = h < scene.h ? below : above;
    if (better(text, best, scene.h)) best = text;
  }
  if (below == above) return below;
  return below + (below.empty() || above.empty() ? "" : " or ") + above;
}

/// The lengths next to x that are whole multiples of a unit.
std::string good_lengths(double x, double unit) {
  const double n = std::floor(x / unit);
  const std::string above = number((n + 1.0) * unit);
  return n < 1.0 ? above : number(n * unit) + " or " + above;
}

void check_cells(const Scene& scene) {
  // first of all: what follows counts cells in integers
  double cells = 1.0;
  for (std::size_t k = 0; k < scene.dimensions(); ++k) cells *= scene.domain[k] / scene.h;
  if (!(cells <= max_cells)) {
    const double least = scene.h * per_axis(scene, cells / max_cells) * 1.0005;
    throw InputError("grid.h",
                     "the box has " + number(cells, 3) +
                         " cells, more than memory is likely to hold (" + number(max_cells) + ")" +
                         (std::isfinite(least) ? "; h >= " + number(least, 3) + " m would do"
                                               : "; give a larger h"));
  }
  if (!is_whole_multiple(scene.domain[0], scene.h)) {
    std::string near = nearby_h(scene, true);
    if (near.empty()) near = nearby_h(scene, false);
    throw InputError(
        "grid.h", "h = " + number(scene.h) + " m does not divide the box's width of " +
                      number(scene.domain[0]) + " m (" + number(scene.domain[0] / scene.h, 6) +
                      " cells); " +
                      (near.empty() ? "it must be at most the width" : "h = " + near + " m would"));
  }
  if (!is_whole_multiple(scene.domain[1], scene.h))
    throw InputError("domain.size", "the box's height of " + number(scene.domain[1]) + " m is " +
                                        number(scene.domain[1] / scene.h, 6) +
                                        " cells of h = " + number(scene.h) + " m; " +
                                        good_lengths(scene.domain[1], scene.h) + " m would fit");
  if (scene.dimensions() == 3 && !is_whole_multiple(scene.domain[2], scene.h))
    throw InputError("domain.size", "the box's depth of " + number(scene.domain[2]) + " m is " +
                                        number(scene.domain[2] / scene.h, 6) +
                                        " cells of h = " + number(scene.h) + " m; " +
                                        good_lengths(scene.domain[2], scene.h) + " m would fit");
  // opposite walls must not share a node that both mirror
  const auto end = scene.domain.begin() + static_cast<std::ptrdiff_t>(scene.dimensions());
  const double least = *std::min_element(scene.domain.begin(), end) / scene.h;
  if (least < min_cells - 0.5)
    throw InputError("grid.h", "the box is " + number(std::round(least)) +
                                   " cells across; the walls need at least " + number(min_cells) +
                                   " between them: h <= " + number(least * scene.h / min_cells) +
                                   " m");
}

void check_geometry(const Scene& scene) {
  if (scene.bodies.empty()) throw InputError("body", "a scene needs at least one [[body]]");
  const double spacing = point_spacing(scene);
  const char* const axis[3] = {"x", "y", "z"};
  double points = 0.0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    for (std::size_t k = 0; k < scene.dimensions(); ++k) {
      if (!std::isfinite(body.origin[k]) || !std::isfinite(body.velocity[k]) ||
          !std::isfinite(body.spin))
        throw InputError(path_of(i, "origin"), "origin, velocity and spin must be finite");
      if (!(body.size[k] > 0.0) || !std::isfinite(body.size[k]))
        throw InputError(path_of(i, "size"), "size must be > 0 m");
      const double end = body.origin[k] + body.size[k];
      const double slack = 1e-9 * scene.domain[k];
      if (body.origin[k] < -slack || end > scene.domain[k] + slack)
        throw InputError(path_of(i, body.size[k] > scene.domain[k] + slack ? "size" : "origin"),
                         "the body reaches from " + std::string(axis[k]) + " = " +
                             number(body.origin[k]) + " to " + number(end) +
                             " m, outside the box [0, " + number(scene.domain[k]) + "] m");
    }
    points += expected_points(scene, body);
  }
  if (points > max_points)
    throw InputError(
        "grid.h",
        "h = " + number(scene.h) + " m with " + std::to_string(scene.points_per_cell) +
            " points per cell makes " + number(points, 3) +
            " points, more than memory is likely to hold (" + number(max_points) + "); h >= " +
            number(scene.h * per_axis(scene, points / max_points) * 1.0005, 3) + " m would do");
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    for (std::size_t k = 0; k < scene.dimensions(); ++k) {
      const double size = scene.bodies[i].size[k];
      if (is_cut(scene.bodies[i]) || scene.bodies[i].release || is_whole_multiple(size, spacing))
        continue;
      const std::string near = nearby_h(scene, true);
      throw InputError(path_of(i, "size"), "the points cannot represent " + number(size) +
                                               " m along " + axis[k] + " exactly: they stand " +
                                               number(spacing) + " m apart (h/" +
                                               std::to_string(points_per_edge(scene)) + "); " +
                                               good_lengths(size, spacing) + " m would do" +
                                               (near.empty() ? "" : ", or h = " + near + " m"));
    }
}

/// The ground and what is released on it.
void check_terrain(const Scene& scene) {
  std::size_t released = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!scene.bodies[i].release) continue;
    if (!scene.terrain || !scene.terrain->release)
      throw InputError(path_of(i, "shape"),
                       "shape = \"release\" needs terrain.release, a map of depths or regions");
    if (++released > 1)
      throw InputError(path_of(i, "shape"), "the terrain's release can be one body only");
  }
  if (!scene.terrain) return;
  const Terrain& terrain = *scene.terrain;
  if (scene.dimensions() != 3)
    throw InputError("domain.size", "a terrain is for scenes in space: [x, y, z]");
  if (scene.tilt_deg != 0.0)
    throw InputError("scene.tilt_deg", "on a terrain, gravity points down: leave the tilt out");
  if (terrain.release && released == 0)
    throw InputError("terrain.release",
                     "no body takes what is released: a [[body]] with shape = \"release\" does");
  if (terrain.contact == Surface::Contact::friction && !terrain.friction_map)
    require(terrain.friction, not_negative, "terrain.friction", "friction");
  if (terrain.least_depth)
    require(*terrain.least_depth, positive, "terrain.least_depth", "least_depth");
  const std::array<double, 2> map{terrain.ground_map.width(), terrain.ground_map.height()};
  for (const std::size_t k : {0U, 2U})
    if (scene.domain[k] > map[k / 2] * (1.0 + 1e-9))
      throw InputError("domain.size", "the box is " + number(scene.domain[k]) + " m long along " +
                                          (k == 0 ? "x" : "z") + ", and the map of the ground " +
                                          number(map[k / 2]) + " m");
  if (terrain.release)
    for (const std::size_t k : {0U, 1U})
      if (terrain.release->low()[k] < 0.0 || terrain.release->high()[k] > scene.domain[2 * k])
        throw InputError("terrain.release",
                         "what is released reaches from " + number(terrain.release->low()[k]) +
                             " to " + number(terrain.release->high()[k]) + " m to the " +
                             (k == 0 ? "east of the ground's western" : "south of its northern") +
                             " edge, and the box from 0 to " + number(scene.domain[2 * k]) +
                             " m: are both maps in the same coordinates?");
  if (terrain.ground->lowest() < 0.0)
    throw InputError("terrain.base", "the ground is " + number(-terrain.ground->lowest()) +
                                         " m lower than the box's floor in places");
}

void check_inflow(const Scene& scene, std::size_t i) {
  const Inflow& inflow = scene.inflows[i];
  const std::string path = "inflow[" + std::to_string(i) + "].";
  const auto refuse = [&](const char* key, const std::string& why) {
    throw InputError(path + key, why);
  };
  if (inflow.edge >= 2 * scene.dimensions())
    refuse("edge", "near and far are edges of a scene in space");
  if (inflow.body >= scene.bodies.size()) refuse("body", "there is no such body");
  if (inflow.speed.has_value() == inflow.rate.has_value())
    refuse(inflow.speed ? "rate" : "speed",
           "give either speed or rate: the other follows from the density and the width");
  const double given = inflow.speed.value_or(inflow.rate.value_or(0.0));
  require(given, positive, (path + (inflow.speed ? "speed" : "rate")).c_str(),
          inflow.speed ? "speed" : "rate");
  require(inflow.starts, not_negative, (path + "starts").c_str(), "starts");
  if (!(inflow.stops > inflow.starts))
    refuse("stops", "it would end at " + number(inflow.stops) + " s, before it begins at " +
                        number(inflow.starts) + " s");
  if (scene.dimensions() == 2 && (std::isfinite(inflow.from[1]) || std::isfinite(inflow.to[1])))
    refuse("from", "in the plane an edge has one direction: a number, not a pair");
  const Stretch stretch = stretch_of(scene, inflow);
  for (std::size_t k = 0; k + 1 < scene.dimensions(); ++k) {
    if (!(stretch.from[k] < stretch.to[k]))
      refuse("from", "it would begin at " + number(stretch.from[k]) + " m and end at " +
                         number(stretch.to[k]) + " m");
    for (const auto& [end, key] : {std::pair{stretch.from[k], "from"}, {stretch.to[k], "to"}})
      if (std::abs(end / scene.h - std::round(end / scene.h)) > lattice_tolerance)
        refuse(key, "an inflow begins and ends at whole cells of h = " + number(scene.h) +
                        " m: " + number(end) + " m is " + number(end / scene.h, 6) + "; " +
                        good_lengths(end, scene.h) + " m would do");
  }
  for (std::size_t j = 0; j < i; ++j) {
    const Inflow& other = scene.inflows[j];
    const Stretch there = stretch_of(scene, other);
    const bool apart = other.edge != inflow.edge || other.stops <= inflow.starts ||
                       inflow.stops <= other.starts || there.to[0] <= stretch.from[0] ||
                       stretch.to[0] <= there.from[0] || there.to[1] <= stretch.from[1] ||
                       stretch.to[1] <= there.from[1];
    if (!apart) refuse("from", "it overlaps inflow[" + std::to_string(j) + "]");
  }
  const Body& body = scene.bodies[inflow.body];
  if (body.lithostatic)
    refuse("body",
           "what comes in has the body's initial state, and this body's is lithostatic: "
           "another at every depth");
  const std::string but = "material that comes in does not go with ";
  if (scene.edge(inflow.edge).kind == Wall::Kind::periodic ||
      scene.left.kind == Wall::Kind::periodic)
    refuse("edge", but + "periodic edges yet");
  if (scene.transfer == Transfer::xpic || scene.transfer == Transfer::fmpm)
    throw InputError("step.transfer", but + "transfer = \"" + std::string(name_of(scene.transfer)) +
                                          "\" yet; any other transfer does");
  if (scene.viscosity == Viscosity::implicit_solve)
    throw InputError("step.viscosity", but + "viscosity = \"implicit\" yet");
  // how many come in until the end
  double density = 0.0;
  try {
    density = make_material(body.law)->initial(body.initial).density;
  } catch (const InputError&) {
    return;  // told of the body
  }
  const double time = std::min(inflow.stops, scene.end_time) - inflow.starts;
  const double spacing = point_spacing(scene);
  const double points = std::max(time, 0.0) * speed_of(scene, inflow, density) * stretch.area() /
                        std::pow(spacing, scene.dimensions());
  if (!(points <= max_points))
    refuse(inflow.speed ? "speed" : "rate",
           number(points, 3) + " points would come in, more than memory is likely to hold (" +
               number(max_points) + ")");
}

void check_places(const Scene& scene, const std::vector<Probe>& places, const char* table) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::string path = std::string(table) + "[" + std::to_string(i) + "].";
    for (std::size_t k = 0; k < scene.dimensions(); ++k)
      if (!(places[i].place[k] >= 0.0 && places[i].place[k] <= scene.domain[k]))
        throw InputError(path + "place", "the place lies outside of the box");
    for (std::size_t j = 0; j < i; ++j)
      if (places[i].name == places[j].name)
        throw InputError(path + "name", "there are two of the name \"" + places[i].name + "\"");
  }
}

/// What an extended velocity adds vanishes at walls at rest and knows no images across an edge.
void check_extension(const Scene& scene) {
  if (scene.transfer != Transfer::xpic && scene.transfer != Transfer::fmpm) return;
  for (const auto& [wall, key] : walls_of(scene))
    if (wall.kind == Wall::Kind::periodic || wall.speed != 0.0)
      throw InputError(key,
                       "a periodic edge or a wall that moves does not go with step.transfer = "
                       "\"" +
                           std::string(name_of(scene.transfer)) +
                           "\" yet; any other transfer does");
}

/// An implicit viscosity has something to solve for, among fields that its walls admit, and its
/// strain rates are those of the points: the affine gradient of the nodes' own velocity.
void check_viscosity(const Scene& scene) {
  if (scene.viscosity == Viscosity::explicit_force) return;
  if (std::all_of(scene.bodies.begin(), scene.bodies.end(),
                  [](const Body& body) { return find_law(body.law).has_stress_memory; }))
    throw InputError(
        "step.viscosity",
        "viscosity = \"implicit\" needs a body whose law is a viscosity: newtonian, or "
        "mu_i with form = \"regularised\"");
  if (scene.transfer == Transfer::tpic || scene.transfer == Transfer::xpic ||
      scene.transfer == Transfer::fmpm)
    throw InputError("step.transfer",
                     "transfer = \"" + std::string(name_of(scene.transfer)) +
                         "\" does not go with step.viscosity = \"implicit\": the strain rates that "
                         "it solves for are the affine gradients of \"relaxed\", \"apic\", "
                         "\"aflip\", \"flip\" and \"pic\"");
  for (const auto& [wall, key] : walls_of(scene))
    if (wall.kind == Wall::Kind::friction)
      throw InputError(key,
                       "a wall with friction does not go with step.viscosity = \"implicit\": its "
                       "limit on the shear is not part of the solve; \"no_slip\", \"slip\" and "
                       "\"open\" do");
    else if (wall.kind == Wall::Kind::periodic || wall.speed != 0.0)
      throw InputError(key,
                       "a periodic edge or a wall that moves does not go with step.viscosity = "
                       "\"implicit\" yet; \"no_slip\" at rest, \"slip\" and \"open\" do");
}

/// Its time follows from gravity, and without an end the points would never give way to the grid.
void check_relaxation(const Scene& scene) {
  if (scene.transfer == Transfer::relaxed && !scene.relaxation_time && scene.gravity == 0.0)
    throw InputError("step.transfer",
                     "without gravity, \"relaxed\" needs step.relaxation_time [s]");
}

/// What plane strain alone has (docs/three_dimensions.md).
void check_space(const Scene& scene) {
  if (scene.dimensions() == 2) return;
  const char* const plane_only = " is for plane strain only: this scene has three dimensions";
  if (scene.transfer == Transfer::xpic || scene.transfer == Transfer::fmpm)
    throw InputError("step.transfer",
                     "transfer = \"" + std::string(name_of(scene.transfer)) + "\"" + plane_only +
                         " (\"relaxed\", \"apic\", \"tpic\", \"aflip\", \"flip\" and \"pic\" go)");
  if (scene.viscosity == Viscosity::implicit_solve)
    throw InputError("step.viscosity", std::string("viscosity = \"implicit\"") + plane_only);
  if (scene.pressure_averaging > 0.0)
    throw InputError("step.pressure_averaging", std::string("pressure_averaging") + plane_only);
  for (const auto& [wall, key] : walls_of(scene)) {
    if (wall.kind == Wall::Kind::periodic)
      throw InputError(key, std::string("a periodic edge") + plane_only);
    if (wall.speed != 0.0) throw InputError(key, std::string("a wall that moves") + plane_only);
  }
}

void check_start(const Scene& scene) {
  require(scene.gravity_ramp, not_negative, "scene.gravity_ramp", "gravity_ramp");
  require(scene.water_density, positive, "scene.water_density", "water_density");
  if (scene.bodies.empty()) throw InputError("body", "a scene needs at least one [[body]]");
  if (scene.water_table) {
    require(*scene.water_table, {}, "scene.water_table", "water_table");
    if (scene.tilt_deg != 0.0)
      throw InputError("scene.water_table", "a water table is level: it does not go with tilt_deg");
  }
  if (!scene.start_from.empty()) {
    if (scene.equilibrium.value_or(false))
      throw InputError("scene.start",
                       "\"at_rest\" is for bodies that are lithostatic, not for what another run "
                       "has left (start_from)");
    return;
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (!scene.bodies[i].lithostatic) continue;
    if (scene.gravity_ramp > 0.0)
      throw InputError(path_of(i, "initial.lithostatic"),
                       "a lithostatic body bears its whole weight from the start, which "
                       "scene.gravity_ramp gives it little by little: leave out one of the two");
  }
  if (scene.equilibrium.value_or(false) && has_edges_in_parts(scene))
    throw InputError("scene.start",
                     "\"at_rest\" does not go with edges in parts and inflows yet: over an opening "
                     "nothing rests");
  if (scene.equilibrium.value_or(false) &&
      std::none_of(scene.bodies.begin(), scene.bodies.end(),
                   [](const Body& body) { return body.lithostatic; }))
    throw InputError("scene.start",
                     "\"at_rest\" corrects the stresses of bodies with initial = { lithostatic = "
                     "true }, and there is none");
}

/// What the material says to the state at the base of a lithostatic body.
InitialPoint lithostatic_base(const Scene& scene, const Body& body, const Material& material) {
  const InitialConditions& given = body.initial;
  if (states_stress(given) || given.v || given.density || given.ocr_v)
    throw InputError("lithostatic",
                     "a lithostatic state follows from the weight: beside it only K0 "
                     "and ocr can be given");
  const double g_normal = scene.gravity * std::cos(scene.tilt_deg * std::numbers::pi / 180.0);
  if (!(g_normal > 1e-12))
    throw InputError("lithostatic", "a lithostatic state needs gravity towards the floor");
  InitialConditions base = given;
  const double vertical =
      material.density_at(0.0, given.ocr.value_or(1.0)) * g_normal * body.size[1];
  base.p = vertical * (1.0 + 2.0 * given.K0.value_or(1.0)) / 3.0;
  return material.initial(base);
}

void check_law(const Scene& scene, std::size_t i) {
  const Body& body = scene.bodies[i];
  std::unique_ptr<Material> material;
  try {
    material = make_material(body.law);
  } catch (const InputError& error) {
    throw InputError(path_of(i, "law.") + error.key(), error.what());
  }
  const auto parameters = material->law().parameters;
  if (body.restitution && (!material->law().has_stress_memory ||
                           std::none_of(parameters.begin(), parameters.end(),
                                        [](const ParamInfo& p) { return p.name == "d"; })))
    throw InputError(path_of(i, "restitution"),
                     "contacts damp the elastic waves of a law that has them and a grain diameter "
                     "d: mu_i (form = \"elastoviscoplastic\") or critical_state_mu_i");
  try {
    buoyant_share(scene, *material);
  } catch (const InputError& error) {
    throw InputError(path_of(i, error.key().c_str()), error.what());
  }
  if (!scene.start_from.empty()) return;
  try {
    const InitialPoint start = body.lithostatic ? lithostatic_base(scene, body, *material)
                                                : material->initial(body.initial);
    if (!(start.density > 0.0) || !std::isfinite(start.density))
      throw InputError("density",
                       "the initial density comes out as " + number(start.density) + " kg/m³");
  } catch (const InputError& error) {
    const bool of_law = std::any_of(parameters.begin(), parameters.end(),
                                    [&](const ParamInfo& p) { return p.name == error.key(); });
    throw InputError(path_of(i, of_law ? "law." : "initial.") + error.key(), error.what());
  }
}

}  // namespace

void validate(const Scene& scene) {
  check_numbers(scene);
  check_cells(scene);
  check_periodic(scene);
  check_parts(scene);
  check_terrain(scene);
  if (scene.start_from.empty()) {
    check_solids(scene);
    check_geometry(scene);
    check_discs(scene);
    check_polygons(scene);
    check_overlap(scene);
  }
  check_surfaces(scene);
  check_start(scene);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) check_law(scene, i);
  for (std::size_t i = 0; i < scene.inflows.size(); ++i) check_inflow(scene, i);
  check_places(scene, scene.probes, "probe");
  check_places(scene, scene.tracers, "tracer");
  check_space(scene);
  check_extension(scene);
  check_viscosity(scene);
  check_relaxation(scene);
}

void require_end_in_reach(const Scene& scene, double dt) {
  constexpr double most = 1e11;
  const double steps = scene.end_time / dt;
  if (steps <= most) return;
  throw InputError(scene.dt ? "step.dt" : "scene.end_time",
                   "steps of " + number(dt, 3) + " s would be " + number(steps, 3) + " to " +
                       number(scene.end_time) +
                       " s, more than anybody waits for (1e11); what makes them short is a large "
                       "bulk modulus over the density, small cells, or an explicit viscosity");
}

}  // namespace repose::mpm
