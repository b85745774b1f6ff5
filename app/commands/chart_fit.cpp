#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/commands/chart.hpp"
#include "input/read_chart.hpp"
#include "input/read_fit.hpp"
#include "io/interrupt.hpp"
#include "io/result_folder.hpp"
#include "report/plot/figure.hpp"
#include "report/plot/gnuplot.hpp"
#include "repose_version.hpp"
#include "study/fit/twin.hpp"
#include "study/run/finished_result.hpp"

namespace repose::app {
namespace {

using calibration::Algorithm;
using calibration::Optimum;
using calibration::Problem;
using calibration::TracePoint;

/// Shares of the first objective that the table tells the cost of.
constexpr std::array levels{1e-2, 1e-6, 1e-12};
/// Below this share of the first objective nothing but round-off is left; the pictures end here.
constexpr double floor_of_chart = 1e-20;

struct Run {
  Algorithm algorithm;
  Optimum optimum;
};

/// What is fitted and from where.
struct Task {
  std::string name;
  Problem problem;
  Eigen::VectorXd start;
  std::string input;  ///< the fit as TOML; empty: the twin
};

/// Five parameters of London clay from three tests without noise: the least objective is 0. The
/// start lies off every symmetry of the cube.
Task twin_task() {
  const study::Twin twin = study::cam_clay_twin();
  Problem problem = study::twin_problem(twin, study::cam_clay_tests());
  const auto n = problem.parameters();
  return {"five parameters of Cam-Clay, three tests, no noise", problem,
          Eigen::VectorXd::LinSpaced(n, 0.3, 0.7), ""};
}

Task task_of(const input::FitFile& file) {
  Problem problem(calibration::ParameterSpace(file.free), file.targets, file.balance);
  const Eigen::VectorXd start = problem.space().start();
  return {file.name, std::move(problem), start, file.resolved};
}

double first_objective(const Task& task) {
  calibration::Evaluation at_start;
  task.problem.evaluate(task.start, false, at_start);
  return at_start.objective();
}

/// Trials, with or without derivatives.
long trials(const TracePoint& p) { return p.evaluations + p.gradients; }

/// The first point of a trace at or below an objective; null if it never came there.
const TracePoint* first_below(const Optimum& optimum, double objective) {
  for (const TracePoint& p : optimum.trace)
    if (p.objective <= objective) return &p;
  return nullptr;
}

std::string trace_csv(const std::vector<Run>& runs) {
  std::string text = "algorithm,trials,gradients,time_s,objective\n";
  for (const Run& run : runs)
    for (const TracePoint& p : run.optimum.trace)
      text += fmt::format("{},{},{},{:.6g},{:.10g}\n", run.algorithm.name, trials(p), p.gradients,
                          p.seconds, p.objective);
  return text;
}

std::string table_csv(const std::vector<Run>& runs, double first) {
  std::string text = "algorithm,objective,trials,gradients,time_s,end";
  for (const double level : levels)
    text += fmt::format(",trials_to_{0:.0e},time_to_{0:.0e}_s", level);
  text += "\n";
  for (const Run& run : runs) {
    const Optimum& o = run.optimum;
    text += fmt::format("{},{:.10g},{},{},{:.6g},\"{}\"", run.algorithm.name, o.objective,
                        o.evaluations + o.gradients, o.gradients, o.seconds, o.why);
    for (const double level : levels) {
      const TracePoint* p = first_below(o, level * first);
      text += p == nullptr ? ",," : fmt::format(",{},{:.6g}", trials(*p), p->seconds);
    }
    text += "\n";
  }
  return text;
}

std::string table_text(const std::vector<Run>& runs, double first) {
  std::string text = fmt::format("{:28} {:>11} {:>7}", "", "objective", "trials");
  for (const double level : levels) text += fmt::format(" {:>18}", fmt::format("to {:.0e}", level));
  text += "\n";
  for (const Run& run : runs) {
    const Optimum& o = run.optimum;
    text += fmt::format("{:28} {:>11.3g} {:>7}", run.algorithm.name, o.objective / first,
                        o.evaluations + o.gradients);
    for (const double level : levels) {
      const TracePoint* p = first_below(o, level * first);
      text += fmt::format(
          " {:>18}",
          p == nullptr ? "-" : fmt::format("{} in {:.1f} ms", trials(*p), 1e3 * p->seconds));
    }
    text += "\n";
  }
  return text;
}

/// At most seven algorithms share a panel: as many as colours tell apart.
std::string_view group_of(const Algorithm& a) {
  const auto has = [&](std::string_view part) { return a.name.find(part) != a.name.npos; };
  if (has("DIRECT") || has("STOGO")) return "global: dividing rectangles, branch and bound";
  if (has("TNEWTON")) return "local, with gradients: truncated Newton";
  if (a.global) return "global: random and clustering";
  return a.gradient ? "local, with gradients" : "local, without gradients";
}

report::Figure figure_of(const std::vector<Run>& runs, const std::string& task, double first) {
  report::Figure figure("Algorithms of a fit", task + "; best objective so far over the first one");
  figure.columns = 2;
  std::vector<std::string_view> groups;
  for (const Run& run : runs)
    if (const std::string_view g = group_of(run.algorithm);
        std::find(groups.begin(), groups.end(), g) == groups.end())
      groups.push_back(g);
  for (const std::string_view group : groups)
    for (const bool over_time : {false, true}) {
      report::Axes& axes = figure.add_axes();
      axes.title = std::string(group);
      axes.x = {over_time ? "time (ms)" : "trials, with or without gradient",
                report::AxisScale::logarithmic};
      axes.y = {"objective / first", report::AxisScale::logarithmic};
      std::size_t colour = 0;
      for (const Run& run : runs) {
        if (group_of(run.algorithm) != group) continue;
        std::vector<double> x, y;
        for (const TracePoint& p : run.optimum.trace) {
          x.push_back(over_time ? std::max(1e3 * p.seconds, 1e-3) : static_cast<double>(trials(p)));
          y.push_back(std::max(p.objective / first, floor_of_chart));
        }
        if (x.empty()) continue;
        report::Style style;
        style.colour = report::cycle_colour(colour++);
        axes.line(std::string(run.algorithm.name), x, y, style);
      }
    }
  return figure;
}

}  // namespace

ChartEnd chart_fit(const CommonOptions& options, const std::string& file, bool quick) {
  const io::ResultFolder folder(options.output.empty() ? io::ResultFolder::default_path("chart_fit")
                                                       : std::filesystem::path(options.output));
  input::InputFile given = file.empty() ? input::InputFile::parse("", "chart", options.sets)
                                        : input::InputFile::read(file, options.sets);
  const input::ChartTable chart = input::read_chart(given);
  // a chart of the twin leaves nothing but the table in its input.toml
  const bool twin = file.empty() || !given.root().contains("fit");
  if (!twin)  // read_fit() looks at the other tables
    for (const auto& [key, node] : given.root()) given.expect("", key.str());
  given.throw_if_bad();
  const std::uint64_t seed =
      options.seed != 0 ? options.seed : static_cast<std::uint64_t>(chart.seed.value_or(0));
  calibration::OptimiseOptions settings;
  settings.max_evaluations = chart.evaluations.value_or(quick || chart.quick ? 200 : 2000);
  settings.x_tolerance = 1e-12;
  if (seed != 0) settings.seed = seed;
  Task task = twin ? twin_task()
                   : task_of(input::read_fit(file, options.sets, seed, folder.path() / "runs"));
  const std::string input =
      fmt::format("# The input of this result, by repose {}.\n{}{}", version_string, task.input,
                  input::chart_text(settings.max_evaluations, settings.seed));
  if (options.resume && study::is_finished(folder, input)) return {io::ExitCode::done, true};
  folder.remove_old_outputs();
  folder.write_file("input.toml", input);
  const io::InterruptGuard interrupt;
  task.problem.interrupt_by([&] { return interrupt.requested(); });
  const double first = first_objective(task);

  std::vector<Run> runs;
  for (const Algorithm& algorithm : calibration::algorithms()) {
    if (interrupt.requested()) break;
    runs.push_back(
        {algorithm, calibration::optimise(task.problem, algorithm.name, task.start, settings)});
    folder.write_file("chart.csv", trace_csv(runs));
  }
  folder.write_file("table.csv", table_csv(runs, first));
  try {
    if (!options.no_plot) figure_of(runs, task.name, first).render_svg(folder.file("chart.svg"));
  } catch (const report::PlotError& error) {
    fmt::print(stderr, "warning: no chart.svg: {}\n", error.what());
  }
  const std::string status = interrupt.requested() ? "interrupted" : "done";
  nlohmann::ordered_json summary{
      {"repose", version_string}, {"kind", "chart_fit"},
      {"status", status},         {"task", task.name},
      {"seed", settings.seed},    {"evaluations", settings.max_evaluations},
      {"first_objective", first}, {"algorithms", runs.size()}};
  folder.write_file("summary.json", summary.dump(2) + "\n");
  if (options.json) fmt::print("{}\n", summary.dump());
  if (!options.quiet && !options.json)
    fmt::print(
        "{}, objective over the first one and the trials it took:\n{}{}: chart.csv, "
        "table.csv, chart.svg\n",
        task.name, table_text(runs, first), folder.path().string());
  return {interrupt.requested() ? io::ExitCode::interrupted : io::ExitCode::done};
}

}  // namespace repose::app
