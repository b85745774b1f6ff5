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

void draw_box(Axes& axes, const HeapPicture& picture, double wall) {
  const double w = picture.width_m, h = picture.height_m;
  Style solid;
  solid.colour = Colour::grey;
  const std::array<double, 2> floor_x{-wall, w + wall}, left_x{-wall, 0.0}, right_x{w, w + wall};
  const std::array<double, 2> zero{0.0, 0.0}, below{-wall, -wall}, above{h, h};
  axes.band("", floor_x, below, zero, solid);
  axes.band("", left_x, zero, above, solid);
  axes.band("", right_x, zero, above, solid);
  Style inner;
  inner.colour = Colour::black;
  inner.width_px = 1.6;
  axes.line("", std::array{0.0, 0.0, w, w}, std::array{h, 0.0, 0.0, h}, inner);
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
  for (const mpm::Surface& surface : scene.surfaces) {
    mpm::Polygon outline =
        surface.outline(simulation.time(), plane, {0.0, 0.0}, {scene.domain[0], scene.domain[1]});
    if (outline.corners.size() > 2) picture.surfaces.push_back(std::move(outline));
  }
  write_heap_picture(path, picture);
  return true;
}

}  // namespace repose::report
