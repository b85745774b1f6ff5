#include "report/picture/heap_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <fmt/core.h>

#include "report/picture/terrain_picture.hpp"
#include "report/plot/figure.hpp"

namespace repose::report {

namespace {

constexpr double largest_width_px = 860.0, largest_height_px = 560.0;  // of the box on paper

void check(const HeapPicture& picture) {
  if (!(picture.width_m > 0.0 && picture.height_m > 0.0 && picture.point_spacing_m > 0.0))
    throw std::invalid_argument(
        fmt::format("heap picture: box {} m x {} m, spacing {} m; all must be positive",
                    picture.width_m, picture.height_m, picture.point_spacing_m));
  if (picture.x_m.size() != picture.y_m.size() || picture.x_m.size() != picture.value.size())
    throw std::invalid_argument(fmt::format("heap picture: {} x, {} y, {} values",
                                            picture.x_m.size(), picture.y_m.size(),
                                            picture.value.size()));
}

/// The value below which a part of them lies; sorts as far as needed.
double quantile(std::vector<double>& values, double part) {
  const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

std::string joined(const std::string& first, const std::string& second) {
  return first.empty() ? second : first + "; " + second;
}

/// The colour scale; adds a sentence to the subtitle if it does not reach the extremes.
Axis colour_scale(const HeapPicture& picture, std::string& subtitle) {
  Axis colours;
  colours.label = picture.value_label;
  std::vector<double> values;
  std::copy_if(picture.value.begin(), picture.value.end(), std::back_inserter(values),
               [](double value) { return std::isfinite(value); });
  if (values.empty()) return colours;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double lowest = *least, highest = *most;
  const double lower = quantile(values, 0.005), upper = quantile(values, 0.995);
  // Half as much again as the middle 99 %: the extremes would hide the rest.
  if (lower < upper && highest - lowest > 1.5 * (upper - lower)) {
    colours.lower = lower;
    colours.upper = upper;
    subtitle = joined(subtitle, fmt::format("colours span 99 % of the points, values reach from "
                                            "{:.3g} to {:.3g}",
                                            lowest, highest));
  }
  return colours;
}

/// The rest of an edge from 0 to `length` at `at` across it, without its openings; `level`: it lies
/// along x.
std::vector<std::array<double, 2>> closed(const HeapPicture& picture, bool level, double at,
                                          double length) {
  std::vector<std::array<double, 2>> rest;
  double from = 0.0;
  const std::size_t across = level ? 1 : 0;
  for (const auto& [begin, end] : picture.openings) {
    if (begin[across] != at || end[across] != at) continue;
    if (begin[1 - across] > from) rest.push_back({from, begin[1 - across]});
    from = end[1 - across];
  }
  if (from < length) rest.push_back({from, length});
  return rest;
}

void draw_box(Axes& axes, const HeapPicture& picture, double wall) {
  const double w = picture.width_m, h = picture.height_m;
  Style solid;
  solid.colour = Colour::grey;
  const std::array<double, 2> zero{0.0, 0.0}, below{-wall, -wall};
  for (auto [from, to] : closed(picture, true, 0.0, w)) {
    from = from == 0.0 ? -wall : from;
    to = to == w ? w + wall : to;
    axes.band("", std::array{from, to}, below, zero, solid);
  }
  for (const double x : {0.0, w})
    for (const auto& [from, to] : closed(picture, false, x, h))
      axes.band("", std::array{x == 0.0 ? -wall : w, x == 0.0 ? 0.0 : w + wall},
                std::array{from, from}, std::array{to, to}, solid);
  Style inner;
  inner.colour = Colour::black;
  inner.width_px = 1.6;
  if (picture.openings.empty()) {
    axes.line("", std::array{0.0, 0.0, w, w}, std::array{h, 0.0, 0.0, h}, inner);
    return;
  }
  for (const auto& [from, to] : closed(picture, true, 0.0, w))
    axes.line("", std::array{from, to}, zero, inner);
  for (const double x : {0.0, w})
    for (const auto& [from, to] : closed(picture, false, x, h))
      axes.line("", std::array{x, x}, std::array{from, to}, inner);
  for (const auto& [from, to] : picture.openings)
    axes.dashed("", std::array{from[0], to[0]}, std::array{from[1], to[1]}, inner);
}

void draw_surfaces(Axes& axes, const HeapPicture& picture) {
  Style style;
  style.colour = Colour::black;
  style.width_px = 1.6;
  for (const mpm::Polygon& outline : picture.surfaces) {
    std::vector<double> x, y;
    for (std::size_t k = 0; k <= outline.corners.size(); ++k) {
      x.push_back(outline.corners[k % outline.corners.size()][0]);
      y.push_back(outline.corners[k % outline.corners.size()][1]);
    }
    axes.line("", x, y, style);
  }
}

void draw_gravity(Axes& axes, const HeapPicture& picture) {
  const double angle = *picture.tilt_deg * std::numbers::pi / 180.0;
  const double metres_per_px =
      std::max(picture.width_m / largest_width_px, picture.height_m / largest_height_px);
  const double length = std::min(60.0 * metres_per_px, 0.6 * picture.height_m);
  const double x = picture.width_m - length * (0.35 + std::max(0.0, std::sin(angle)));
  const double y = picture.height_m - 0.25 * length;
  axes.arrow({x, y, x + length * std::sin(angle), y - length * std::cos(angle),
              *picture.tilt_deg == 0.0 ? "gravity"
                                       : fmt::format("gravity, tilt {:g}°", *picture.tilt_deg)});
}

}  // namespace

void write_heap_picture(const std::filesystem::path& path, const HeapPicture& picture) {
  check(picture);
  std::string subtitle = picture.subtitle;
  const Axis colours = colour_scale(picture, subtitle);

  Figure figure(picture.title, subtitle);
  figure.panel_width_px = largest_width_px;
  figure.panel_height_px = largest_height_px;
  Axes& axes = figure.add_axes();
  axes.equal_aspect = true;
  const double wall = 0.012 * std::max(picture.width_m, picture.height_m);
  axes.x = {.label = "x (m)", .lower = -wall, .upper = picture.width_m + wall};
  axes.y = {.label = "y (m)", .lower = -wall, .upper = picture.height_m};

  ScatterStyle style;
  style.diameter = 1.7 * picture.point_spacing_m;  // closes the gaps of an uneven arrangement
  axes.scatter(picture.x_m, picture.y_m, picture.value, colours, style);
  draw_box(axes, picture, wall);
  draw_surfaces(axes, picture);
  if (picture.tilt_deg) draw_gravity(axes, picture);
  figure.render_svg(path);
}

namespace {

/// The open stretches of the edges that a picture at z shows, in space where its plane cuts them.
std::vector<std::array<std::array<double, 2>, 2>> openings_of(const mpm::Scene& scene, double z) {
  std::vector<std::array<std::array<double, 2>, 2>> found;
  for (std::size_t edge = 0; edge < 4; ++edge) {
    const mpm::Wall& wall = scene.edge(edge);
    if (wall.kind != mpm::Wall::Kind::parts) continue;
    const std::size_t along = edge < 2 ? 1 : 0;
    const double length = scene.domain[along], across = scene.domain[1 - along];
    std::vector<double> ends{0.0, length};
    for (const mpm::Wall::Part& part : wall.parts)
      for (const double end : {part.from[0], part.to[0]})
        if (end > 0.0 && end < length) ends.push_back(end);
    std::sort(ends.begin(), ends.end());
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      const double middle = 0.5 * (ends[k] + ends[k + 1]);
      const auto holds =
          std::find_if(wall.parts.begin(), wall.parts.end(), [&](const mpm::Wall::Part& part) {
            return middle >= part.from[0] && middle < part.to[0] && z >= part.from[1] &&
                   z < part.to[1];
          });
      if (holds == wall.parts.end() || holds->kind != mpm::Wall::Kind::open) continue;
      const double at = edge % 2 == 0 ? 0.0 : across;
      if (along == 0)
        found.push_back({{{ends[k], at}, {ends[k + 1], at}}});
      else
        found.push_back({{{at, ends[k]}, {at, ends[k + 1]}}});
    }
  }
  return found;
}

}  // namespace

bool draw_final_picture(const input::SceneFile& file, const mpm::Simulation& simulation,
                        const std::filesystem::path& path) {
  const mpm::Scene& scene = file.scene;
  if (scene.terrain) {
    draw_terrain_picture(simulation, path);
    return true;
  }
  mpm::Simulation::Snapshot shot = simulation.snapshot(file.stress);
  double plane = 0.0;
  std::string title = fmt::format("{} at {:.4g} s", scene.name, simulation.time());
  if (scene.dimensions() == 3) {
    // the cells along z = 0, or the middle of the box where that is no plane of symmetry
    const double z = scene.near.kind == mpm::Wall::Kind::slip ? 0.0 : 0.5 * scene.domain[2];
    shot = shot.slice(z, z + scene.h);
    plane = z + 0.5 * scene.h;
    title += fmt::format(", z = {:.4g} to {:.4g} m", z, z + scene.h);
    if (shot.x_m.empty()) return false;
  }
  const bool mises = file.colour == input::PictureField::mises;
  std::vector<double> values = mises ? shot.mises_Pa : shot.density;
  if (mises)
    for (double& x : values) x *= 1e-3;
  HeapPicture picture;
  picture.title = title;
  picture.width_m = scene.domain[0];
  picture.height_m = scene.domain[1];
  picture.x_m = shot.x_m;
  picture.y_m = shot.y_m;
  picture.value = values;
  picture.value_label = mises ? "von Mises stress (kPa)" : "density (kg/m³)";
  picture.point_spacing_m = mpm::point_spacing(scene);
  if (scene.gravity > 0.0) picture.tilt_deg = scene.tilt_deg;
  picture.openings = openings_of(scene, plane);
  for (const mpm::Surface& surface : scene.surfaces) {
    mpm::Polygon outline =
        surface.outline(simulation.time(), plane, {0.0, 0.0}, {scene.domain[0], scene.domain[1]});
    if (outline.corners.size() > 2) picture.surfaces.push_back(std::move(outline));
  }
  write_heap_picture(path, picture);
  return true;
}

}  // namespace repose::report
