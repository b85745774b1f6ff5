#include "report/picture/heap_picture.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/core.h>

#include "report/picture/terrain_picture.hpp"
#include "report/plot/figure.hpp"

namespace repose::report {

namespace {

void check(const HeapPicture& picture) {
  const mpm::Scene& scene = picture.scene;
  if (!(scene.domain[0] > 0.0 && scene.domain[1] > 0.0 && scene.h > 0.0))
    throw std::invalid_argument(
        fmt::format("heap picture: box {} m x {} m, cells of {} m; all must be positive",
                    scene.domain[0], scene.domain[1], scene.h));
  const bool bodies = !picture.body.empty();
  const std::size_t coloured = bodies ? picture.body.size() : picture.value.size();
  if (picture.x_m.size() != picture.y_m.size() || picture.x_m.size() != coloured)
    throw std::invalid_argument(fmt::format("heap picture: {} x, {} y, {} {}", picture.x_m.size(),
                                            picture.y_m.size(), coloured,
                                            bodies ? "bodies" : "values"));
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

}  // namespace

void write_heap_picture(const std::filesystem::path& path, const HeapPicture& picture) {
  check(picture);
  std::string subtitle = picture.subtitle;
  const Axis colours = colour_scale(picture, subtitle);

  Figure figure(picture.title, subtitle);
  Axes& axes = add_section(figure, picture.scene);
  // closes the gaps of an uneven arrangement
  const double diameter = 1.7 * mpm::point_spacing(picture.scene);
  if (!picture.body.empty()) {
    axes.legend = Legend::right;
    draw_bodies(axes, picture.scene, picture.body, picture.x_m, picture.y_m, diameter);
  } else {
    ScatterStyle style;
    style.diameter = diameter;
    axes.scatter(picture.x_m, picture.y_m, picture.value, colours, style);
  }
  draw_surroundings(axes, picture.scene, picture.section);
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
  const Section section = section_of(simulation);
  if (scene.dimensions() == 3) {
    shot = shot.slice(section.z_m, section.z_m + section.depth_m);
    if (shot.x_m.empty()) return false;
  }
  const bool mises = file.colour == input::PictureField::mises;
  std::vector<double> values = mises ? shot.mises_Pa : shot.density;
  if (mises)
    for (double& x : values) x *= 1e-3;
  HeapPicture picture;
  picture.title = fmt::format("{} at {:.4g} s{}", scene.name, simulation.time(), section.title());
  picture.scene = scene;
  picture.section = section;
  picture.x_m = shot.x_m;
  picture.y_m = shot.y_m;
  if (file.colour == input::PictureField::body) picture.body = shot.body;
  picture.value = values;
  picture.value_label = mises ? "von Mises stress (kPa)" : "density (kg/m³)";
  write_heap_picture(path, picture);
  return true;
}

}  // namespace repose::report
