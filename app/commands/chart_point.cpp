#include <cmath>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/commands/chart.hpp"
#include "input/read_chart.hpp"
#include "io/interrupt.hpp"
#include "io/result_folder.hpp"
#include "pointdriver/study/tangent_convergence.hpp"
#include "pointdriver/study/work_precision.hpp"
#include "report/plot/figure.hpp"
#include "report/plot/gnuplot.hpp"
#include "repose_version.hpp"
#include "study/run/finished_result.hpp"

namespace repose::app {
namespace {

using point::Method;
using point::WorkPoint;

struct Map {
  std::string name;
  std::vector<point::StepError> cells;
};

std::string work_csv(const std::vector<WorkPoint>& points) {
  std::string text =
      "path,method,tolerance,substeps,error,stress_error,state_error,wall_s,wall_lower_s,"
      "wall_upper_s,repeats,steps,rates,completed\n";
  for (const WorkPoint& p : points)
    text += fmt::format("\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{}\n", p.path,
                        point::name_of(p.method), p.tolerance, p.substeps, p.error(),
                        p.stress_error, p.state_error, p.seconds, p.lower, p.upper, p.repeats,
                        p.steps, p.rates, p.completed ? 1 : 0);
  return text;
}

std::string tangent_csv(const std::vector<point::TangentTest>& tests) {
  std::string text = "law,h,remainder\n";
  for (const point::TangentTest& test : tests)
    for (const point::TangentPoint& p : test.points)
      text += fmt::format("\"{}\",{:.6g},{:.6g}\n", test.name, p.h, p.remainder);
  return text;
}

report::Figure tangent_figure(const std::vector<point::TangentTest>& tests) {
  report::Figure figure(
      "Convergence of the laws' tangents",
      "remainder of Taylor's first order around one step; of second order where the "
      "tangent is the derivative of the update");
  figure.panel_width_px = 560.0;
  figure.panel_height_px = 360.0;
  report::Axes& axes = figure.add_axes();
  axes.x = {"perturbation over the step", report::AxisScale::logarithmic};
  axes.y = {"remainder over change", report::AxisScale::logarithmic};
  axes.legend = report::Legend::right;
  std::size_t colour = 0;
  for (const point::TangentTest& test : tests) {
    std::vector<double> h, remainder;
    for (const point::TangentPoint& p : test.points)
      if (p.remainder > 0.0) {
        h.push_back(p.h);
        remainder.push_back(p.remainder);
      }
    report::Style style;
    style.colour = report::cycle_colour(colour++);
    if (colour > 7) style.marker = report::Marker::circle;  // one more than colours tell apart
    if (!h.empty())
      axes.line(fmt::format("{}: {:.2f}", test.name, test.order), h, remainder, style);
  }
  const std::array ends{1e-5, 1e-1}, second{1e-12, 1e-4};
  axes.dashed("second order", ends, second, {report::Colour::black, 1.2});
  return figure;
}

std::string map_csv(const std::vector<Map>& maps) {
  std::string text = "start,eps_v,eps_q,error\n";
  for (const Map& map : maps)
    for (const point::StepError& c : map.cells)
      text += fmt::format("\"{}\",{},{},{}\n", map.name, c.eps_v, c.eps_q, c.error);
  return text;
}

report::Figure work_figure(const std::vector<WorkPoint>& points) {
  report::Figure figure(
      "Work and precision of the integrators",
      "one path with 50 rows, in process; largest error of stress and state in any row; "
      "median of the repeats, bars: quartiles");
  figure.columns = 3;
  figure.panel_width_px = 330.0;
  figure.panel_height_px = 250.0;
  std::vector<std::string> paths;
  for (const WorkPoint& p : points)
    if (paths.empty() || paths.back() != p.path) paths.push_back(p.path);
  for (const std::string& path : paths) {
    report::Axes& axes = figure.add_axes();
    axes.title = path;
    axes.x = {"error (relative)", report::AxisScale::logarithmic};
    axes.y = {"time (µs)", report::AxisScale::logarithmic};
    axes.legend = figure.panels().size() == 3 ? report::Legend::right : report::Legend::none;
    std::size_t colour = 0;
    for (const Method method :
         {Method::adaptive, Method::cvode, Method::ida, Method::arkode, Method::implicit}) {
      std::vector<double> error, time;
      for (const WorkPoint& p : points)
        if (p.path == path && p.method == method && p.completed && p.error() > 0.0) {
          error.push_back(p.error());
          time.push_back(1e6 * p.seconds);
        }
      report::Style style;
      style.colour = report::cycle_colour(colour++);
      style.marker = report::Marker::circle;
      style.marker_px = 5.0;
      if (!error.empty()) axes.line(std::string(point::name_of(method)), error, time, style);
      style.marker.reset();
      style.width_px = 1.0;
      for (const WorkPoint& p : points) {
        if (p.path != path || p.method != method || !p.completed || !(p.error() > 0.0)) continue;
        const std::array at{p.error(), p.error()}, bar{1e6 * p.lower, 1e6 * p.upper};
        axes.line("", at, bar, style);
      }
    }
  }
  return figure;
}

report::Figure map_figure(const std::vector<Map>& maps) {
  report::Figure figure("Error of one stress update",
                        "log10 |σ − σ_{exact}|/|σ_{exact}| of a single implicit step, London clay");
  figure.columns = 2;
  for (const Map& map : maps) {
    report::Axes& axes = figure.add_axes();
    axes.title = map.name;
    axes.x.label = "Δε_{v} (%), compression positive";
    axes.y.label = "Δε_{q} (%)";
    std::vector<double> x, y, z;
    for (const point::StepError& c : map.cells) {
      x.push_back(100.0 * c.eps_v);
      y.push_back(100.0 * c.eps_q);
      z.push_back(c.error >= 0.0 ? std::log10(std::max(c.error, 1e-12)) : std::nan(""));
    }
    report::ScatterStyle style;
    style.diameter = 200.0 * (map.cells.back().eps_v - map.cells.front().eps_v) /
                     (2.0 * (std::sqrt(static_cast<double>(map.cells.size())) - 1.0));
    axes.scatter(x, y, z, report::Axis{"log_{10} error"}, style);
  }
  return figure;
}

std::vector<Map> error_maps(int cells) {
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
  return {
      {"at yield, q = 0", point::step_error_map(law, theta, start(0.0, 0.0), reach, cells)},
      {"at yield, q/p = M/2", point::step_error_map(law, theta, start(0.444, 0.0), reach, cells)},
      {"critical state", point::step_error_map(law, theta, start(0.888, 0.0), reach, cells)},
      {"OCR 1.5", point::step_error_map(law, theta, start(0.0, 1.5), reach, cells)}};
}

void draw(const report::Figure& figure, const std::filesystem::path& file) {
  try {
    figure.render_svg(file);
  } catch (const report::PlotError& error) {
    fmt::print(stderr, "warning: no {}: {}\n", file.filename().string(), error.what());
  }
}

}  // namespace

ChartEnd chart_point(const CommonOptions& options, const std::string& file, bool quick) {
  const io::ResultFolder folder(options.output.empty()
                                    ? io::ResultFolder::default_path("chart_point")
                                    : std::filesystem::path(options.output));
  input::InputFile given = file.empty() ? input::InputFile::parse("", "chart", options.sets)
                                        : input::InputFile::read(file, options.sets);
  quick = input::read_chart(given).quick || quick;
  given.throw_if_bad();
  const std::string input =
      fmt::format("# The input of this result, by repose {}.\n{}", version_string,
                  input::chart_text(input::ChartKind::point, quick));
  if (options.resume && study::is_finished(folder, input)) return {io::ExitCode::done, true};
  folder.remove_old_outputs();
  folder.write_file("input.toml", input);
  const bool speak = !options.quiet && !options.json;
  const point::WorkEffort effort{quick ? 0.0 : 0.02, quick ? 3 : 1};
  const io::InterruptGuard interrupt;
  std::vector<WorkPoint> points;
  for (const point::WorkPath& path : point::work_paths()) {
    if (interrupt.requested()) break;
    const std::vector<WorkPoint> more = point::work_precision(path, effort);
    points.insert(points.end(), more.begin(), more.end());
    folder.write_file("chart.csv", work_csv(points));
    if (speak) fmt::print("{}: {} settings\n", path.name, more.size());
  }
  nlohmann::ordered_json summary{{"repose", version_string},
                                 {"kind", "chart_point"},
                                 {"status", interrupt.requested() ? "interrupted" : "done"},
                                 {"quick", quick},
                                 {"settings", points.size()}};
  if (!interrupt.requested()) {
    const std::vector<Map> maps = error_maps(quick ? 11 : 41);
    const std::vector<point::TangentTest> tangents = point::tangent_convergence();
    folder.write_file("error_map.csv", map_csv(maps));
    folder.write_file("tangent.csv", tangent_csv(tangents));
    if (!options.no_plot) {
      draw(work_figure(points), folder.file("chart.svg"));
      draw(map_figure(maps), folder.file("error_map.svg"));
      draw(tangent_figure(tangents), folder.file("tangent.svg"));
    }
    for (const point::TangentTest& test : tangents) {
      summary["tangent_order"][test.name] = test.order;
      if (speak) fmt::print("{}: its tangent is of order {:.2f}\n", test.name, test.order);
    }
  }
  folder.write_file("summary.json", summary.dump(2) + "\n");
  if (options.json) fmt::print("{}\n", summary.dump());
  if (speak)
    fmt::print("{}: chart.csv, chart.svg, error_map.csv, error_map.svg, tangent.csv, tangent.svg\n",
               folder.path().string());
  return {interrupt.requested() ? io::ExitCode::interrupted : io::ExitCode::done};
}

}  // namespace repose::app
