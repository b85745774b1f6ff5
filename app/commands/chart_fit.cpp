#include <fmt/core.h>

#include "app/commands/chart.hpp"
#include "input/program_identity.hpp"
#include "input/read_chart.hpp"
#include "input/read_fit.hpp"
#include "io/interrupt.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "models/instruction_set.hpp"
#include "report/picture/fit_chart_picture.hpp"
#include "repose_version.hpp"
#include "study/chart/fit_chart.hpp"
#include "study/run/finished_result.hpp"

namespace repose::app {
namespace {

using calibration::Optimum;
using study::AlgorithmRun;

std::string table_text(const std::vector<AlgorithmRun>& runs, double first) {
  std::string text = fmt::format("{:28} {:>11} {:>7}", "", "objective", "trials");
  for (const double level : study::objective_levels)
    text += fmt::format(" {:>18}", fmt::format("to {:.0e}", level));
  text += "\n";
  for (const AlgorithmRun& run : runs) {
    const Optimum& o = run.optimum;
    text += fmt::format("{:28} {:>11.3g} {:>7}", run.algorithm.name, o.objective / first,
                        o.evaluations + o.gradients);
    for (const double level : study::objective_levels) {
      const calibration::TracePoint* p = study::first_below(o, level * first);
      text += fmt::format(
          " {:>18}",
          p == nullptr ? "-" : fmt::format("{} in {:.1f} ms", study::trials(*p), 1e3 * p->seconds));
    }
    text += "\n";
  }
  return text;
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
  study::FitTask task =
      twin ? study::twin_task()
           : study::task_of(input::read_fit(file, options.sets, seed, folder.path() / "runs"));
  const std::string input =
      fmt::format("# The input of this result, by repose {}.\n{}{}", input::program_identity(),
                  task.input, input::chart_text(settings.max_evaluations, settings.seed));
  const io::FolderClaim claim(folder);
  if (options.resume && study::is_finished(folder, input)) return {io::ExitCode::done, true};
  folder.remove_old_outputs();
  folder.write_file("input.toml", input);
  const io::InterruptGuard interrupt;
  task.problem.interrupt_by([&] { return interrupt.requested(); });
  const double first = study::first_objective(task);

  std::vector<AlgorithmRun> runs;
  for (const calibration::Algorithm& algorithm : calibration::algorithms()) {
    if (interrupt.requested()) break;
    runs.push_back(
        {algorithm, calibration::optimise(task.problem, algorithm.name, task.start, settings)});
    folder.write_file("chart.csv", study::trace_csv(runs));
  }
  folder.write_file("table.csv", study::table_csv(runs, first));
  if (!options.no_plot)
    drawn(report::fit_chart_figure(runs, task.name, first), folder.file("chart.svg"));
  const std::string status = interrupt.requested() ? "interrupted" : "done";
  io::Json summary{{"repose", version_string},
                   {"instruction_set", std::string(instruction_set())},
                   {"kind", "chart_fit"},
                   {"status", status},
                   {"task", task.name},
                   {"seed", settings.seed},
                   {"evaluations", settings.max_evaluations},
                   {"first_objective", first},
                   {"algorithms", runs.size()}};
  folder.write_file("summary.json", summary.dump(2) + "\n");
  folder.seal();
  if (options.json) fmt::print("{}\n", summary.dump());
  if (!options.quiet && !options.json)
    fmt::print(
        "{}, objective over the first one and the trials it took:\n{}{}: chart.csv, "
        "table.csv, chart.svg\n",
        task.name, table_text(runs, first), folder.path().string());
  return {interrupt.requested() ? io::ExitCode::interrupted : io::ExitCode::done};
}

}  // namespace repose::app
