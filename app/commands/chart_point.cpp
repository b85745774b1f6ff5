#include <fmt/core.h>

#include "app/commands/chart.hpp"
#include "input/read_chart.hpp"
#include "io/interrupt.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "report/picture/point_chart_picture.hpp"
#include "repose_version.hpp"
#include "study/chart/point_chart.hpp"
#include "study/run/finished_result.hpp"

namespace repose::app {

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
  const io::FolderClaim claim(folder);
  if (options.resume && study::is_finished(folder, input)) return {io::ExitCode::done, true};
  folder.remove_old_outputs();
  folder.write_file("input.toml", input);
  const bool speak = !options.quiet && !options.json;
  const point::WorkEffort effort{quick ? 0.0 : 0.02, quick ? 3 : 1};
  const io::InterruptGuard interrupt;
  std::vector<point::WorkPoint> points;
  for (const point::WorkPath& path : point::work_paths()) {
    if (interrupt.requested()) break;
    const std::vector<point::WorkPoint> more = point::work_precision(path, effort);
    points.insert(points.end(), more.begin(), more.end());
    folder.write_file("chart.csv", study::work_csv(points));
    if (speak) fmt::print("{}: {} settings\n", path.name, more.size());
  }
  io::Json summary{{"repose", version_string},
                   {"kind", "chart_point"},
                   {"status", interrupt.requested() ? "interrupted" : "done"},
                   {"quick", quick},
                   {"settings", points.size()}};
  if (!interrupt.requested()) {
    const std::vector<study::ErrorMap> maps = study::error_maps(quick ? 11 : 41);
    const std::vector<point::TangentTest> tangents = point::tangent_convergence();
    folder.write_file("error_map.csv", study::error_map_csv(maps));
    folder.write_file("tangent.csv", study::tangent_csv(tangents));
    if (!options.no_plot) {
      drawn(report::work_figure(points), folder.file("chart.svg"));
      drawn(report::error_map_figure(maps), folder.file("error_map.svg"));
      drawn(report::tangent_figure(tangents), folder.file("tangent.svg"));
    }
    for (const point::TangentTest& test : tangents) {
      summary["tangent_order"][test.name] = test.order;
      if (speak) fmt::print("{}: its tangent is of order {:.2f}\n", test.name, test.order);
    }
  }
  folder.write_file("summary.json", summary.dump(2) + "\n");
  folder.seal();
  if (options.json) fmt::print("{}\n", summary.dump());
  if (speak)
    fmt::print("{}: chart.csv, chart.svg, error_map.csv, error_map.svg, tangent.csv, tangent.svg\n",
               folder.path().string());
  return {interrupt.requested() ? io::ExitCode::interrupted : io::ExitCode::done};
}

}  // namespace repose::app
