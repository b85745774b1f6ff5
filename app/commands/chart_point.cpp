#include <cmath>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/commands/chart.hpp"
#include "app/plot/figure.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/read_chart.hpp"
#include "app/result_folder.hpp"
#include "pointdriver/work_precision.hpp"
#include "repose_version.hpp"

namespace repose::app {
namespace {

using point::Method;
using point::WorkPoint;

constexpr double seconds_each = 0.02;  ///< repeats of one setting; the shortest counts

struct Map {
  std::string name;
  std::vector<point::StepError> cells;
};

std::string work_csv(const std::vector<WorkPoint>& points) {
  std::string text = "path,method,tolerance,substeps,error,wall_s,steps,rates,completed\n";
  for (const WorkPoint& p : points)
    text += fmt::format("\"{}\",{},{},{},{},{},{},{},{}\n", p.path, point::name_of(p.method),
                        p.tolerance, p.substeps, p.error, p.seconds, p.steps, p.rates,
                        p.completed ? 1 : 0);
  return text;
}

std::string map_csv(const std::vector<Map>& maps) {
  std::string text = "start,eps_v,eps_q,error\n";
  for (const Map& map : maps)
    for (const point::StepError& c : map.cells)
      text += fmt::format("\"{}\",{},{},{}\n", map.name, c.eps_v, c.eps_q, c.error);
  return text;
}

Figure work_figure(const std::vector<WorkPoint>& points) {
  Figure figure("Work and precision of the integrators",
                "one path with 50 rows, in process; largest error in any row (p and q over p, "
                "ε_{v} over its largest); "
                "shortest of the repeats");
  figure.columns = 2;
  std::vector<std::string> paths;
  for (const WorkPoint& p : points)
    if (paths.empty() || paths.back() != p.path) paths.push_back(p.path);
  for (const std::string& path : paths) {
    Axes& axes = figure.add_axes();
    axes.title = path;
    axes.x = {"error (relative)", AxisScale::logarithmic};
    axes.y = {"time (µs)", AxisScale::logarithmic};
    std::size_t colour = 0;
    for (const Method method :
         {Method::adaptive, Method::cvode, Method::ida, Method::arkode, Method::implicit}) {
      std::vector<double> error, time;
      for (const WorkPoint& p : points)
        if (p.path == path && p.method == method && p.completed && p.error > 0.0) {
          error.push_back(p.error);
          time.push_back(1e6 * p.seconds);
        }
      Style style;
      style.colour = cycle_colour(colour++);
      style.marker = Marker::circle;
      style.marker_px = 5.0;
      if (!error.empty()) axes.line(std::string(point::name_of(method)), error, time, style);
    }
  }
  return figure;
}

Figure map_figure(const std::vector<Map>& maps) {
  Figure figure("Error of one stress update",
                "log10 |σ − σ_{exact}|/|σ_{exact}| of a single implicit step, London clay");
  figure.columns = 2;
  for (const Map& map : maps) {
    Axes& axes = figure.add_axes();
    axes.title = map.name;
    axes.x.label = "Δε_{v} (%), compression positive";
    axes.y.label = "Δε_{q} (%)";
    std::vector<double> x, y, z;
    for (const point::StepError& c : map.cells) {
      x.push_back(100.0 * c.eps_v);
      y.push_back(100.0 * c.eps_q);
      z.push_back(c.error >= 0.0 ? std::log10(std::max(c.error, 1e-12)) : std::nan(""));
    }
    ScatterStyle style;
    style.diameter = 200.0 * map.cells.back().eps_v / 40.0;
    axes.scatter(x, y, z, Axis{"log_{10} error"}, style);
  }
  return figure;
}

std::vector<Map> error_maps() {
  const std::vector<point::WorkPath> paths = point::work_paths();
  const LawInfo& law = find_law(paths.front().law);
  const std::vector<double> theta = checked_parameters(paths.front().law);
  const auto start = [](double q_over_p, double ocr) {
    // σ_a = p + 2q/3, σ_r = p − q/3 at p = 100 kPa
    InitialConditions given;
    const double p = 100e3, q = q_over_p * p;
    given.sigma = {{p - q / 3.0, p + 2.0 * q / 3.0, p - q / 3.0, 0.0, 0.0, 0.0}};
    if (ocr > 0.0) given.ocr = ocr;
    return given;
  };
  constexpr double reach = 0.02;
  constexpr int cells = 41;
  return {
      {"at yield, q = 0", point::step_error_map(law, theta, start(0.0, 0.0), reach, cells)},
      {"at yield, q/p = M/2", point::step_error_map(law, theta, start(0.444, 0.0), reach, cells)},
      {"critical state", point::step_error_map(law, theta, start(0.888, 0.0), reach, cells)},
      {"OCR 1.5", point::step_error_map(law, theta, start(0.0, 1.5), reach, cells)}};
}

void draw(const Figure& figure, const std::filesystem::path& file) {
  try {
    figure.render_svg(file);
  } catch (const PlotError& error) {
    fmt::print(stderr, "warning: no {}: {}\n", file.filename().string(), error.what());
  }
}

}  // namespace

ExitCode chart_point(const CommonOptions& options) {
  const ResultFolder folder(options.output.empty() ? ResultFolder::default_path("chart_point")
                                                   : std::filesystem::path(options.output));
  folder.remove_old_outputs();
  folder.write_file("input.toml", fmt::format("# The input of this result, by repose {}.\n{}",
                                              version_string, chart_text(ChartKind::point)));
  std::vector<WorkPoint> points;
  for (const point::WorkPath& path : point::work_paths()) {
    const std::vector<WorkPoint> more = point::work_precision(path, seconds_each);
    points.insert(points.end(), more.begin(), more.end());
    if (!options.quiet && !options.json) fmt::print("{}: {} settings\n", path.name, more.size());
  }
  const std::vector<Map> maps = error_maps();
  folder.write_file("chart.csv", work_csv(points));
  folder.write_file("error_map.csv", map_csv(maps));
  draw(work_figure(points), folder.file("chart.svg"));
  draw(map_figure(maps), folder.file("error_map.svg"));
  nlohmann::ordered_json summary{{"repose", version_string},
                                 {"kind", "chart_point"},
                                 {"status", "done"},
                                 {"settings", points.size()}};
  folder.write_file("summary.json", summary.dump(2) + "\n");
  if (!options.quiet)
    fmt::print("{}: chart.csv, chart.svg, error_map.csv, error_map.svg\n", folder.path().string());
  return ExitCode::done;
}

}  // namespace repose::app
