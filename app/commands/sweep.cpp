#include "app/commands/sweep.hpp"

#include <fmt/format.h>

#include "app/commands/sweep_folder.hpp"
#include "input/read_point_test.hpp"
#include "input/read_scene.hpp"
#include "input/shipped_input.hpp"
#include "report/picture/parameter_sweep_picture.hpp"
#include "study/point/point_sweep.hpp"
#include "study/run/scene_sweep.hpp"

namespace repose::app {

io::ExitCode run_point_sweep(const std::string& path, const input::InputFile& file,
                             const input::ParameterSets& sets, const CommonOptions& options) {
  const SweepFolder at("sweep", "sweep.csv", path, file, options);
  study::PointSweep sweep(file, sets, "sweep");
  if (at.is_kept()) return io::ExitCode::done;
  const io::ExitCode code = sweep.run(at.folder(), options.threads, at.begin());
  at.folder().write_file("sweep.csv", sweep.table());
  const bool drawn = code == io::ExitCode::done && at.draw([&] {
    return report::point_sweep_picture(sweep, at.name(), at.folder().file("curves.csv"));
  });
  return at.end(sweep.counts(), code,
                io::Json{{"runs_kept", sweep.kept()}, {"driving_s", sweep.driving_s()}},
                drawn ? "sweep.csv, curves.csv, sweep.svg" : "sweep.csv, curves.csv");
}

io::ExitCode run_scene_sweep(const std::string& path, const input::InputFile& file,
                             const input::ParameterSets& sets, const CommonOptions& options) {
  const SweepFolder at("sweep", "sweep.csv", path, file, options);
  study::SceneSweep sweep(file, sets, "sweep", true);
  if (at.is_kept()) return io::ExitCode::done;
  const auto tell = [&](std::size_t run) {
    const study::RunSummary& summary = sweep.cases()[run - 1].summary;
    if (options.quiet || options.json) return;
    fmt::print("[{}/{}] {}", run, sweep.cases().size(), summary.status);
    for (std::size_t i = 0; i < sets.keys.size(); ++i)
      fmt::print(", {} = {}", sets.keys[i], sets.values[run - 1][i]);
    for (const char* const figure : {"front_m", "front_99_m", "height_m"})
      if (const auto found = summary.figures.find(figure); found != summary.figures.end())
        fmt::print(", {} = {:.4g}", figure, found->second);
    fmt::print("\n");
    std::fflush(stdout);
  };
  const io::ExitCode code = sweep.run(at.folder(), options.threads, options.seed, at.begin(), tell);
  at.folder().write_file("sweep.csv", sweep.table());
  const bool drawn = code == io::ExitCode::done && sweep.count("done") > 0 && at.draw([&] {
    return report::scene_sweep_picture(sweep, at.name(), at.folder().file("runs"));
  });
  return at.end(sweep.counts(), code, io::Json::object(),
                drawn ? "sweep.csv, sweep.svg, runs/" : "sweep.csv, runs/");
}

void check_sweep(const std::string& path, const input::ParameterSets& sets, bool is_scene,
                 const CommonOptions& options) {
  constexpr double seconds = 0.5;  // a sweep of 20 000 scenes takes longer to read through
  std::size_t refused = 0, first = 0, looked_at = 0;
  std::string reason;
  const auto look = [&](const auto& cases) {
    looked_at = cases.size();
    for (std::size_t k = 0; k < cases.size(); ++k) {
      if (cases[k].refusal.empty()) continue;
      if (refused++ > 0) continue;
      first = k + 1;
      reason = cases[k].refusal;
    }
  };
  if (is_scene)
    look(study::cases_of<study::SceneCase>(
        input::open_scene(path, options.sets), sets, "sweep",
        [](study::SceneCase&, input::InputFile& run, std::size_t) { input::read_scene(run); },
        seconds));
  else
    look(study::cases_of<study::PointCase>(
        input::open_test(path, options.sets), sets, "sweep",
        [](study::PointCase&, input::InputFile& run, std::size_t) { input::read_point_test(run); },
        seconds));
  if (!options.quiet)
    fmt::print("  sweep        {} runs over {}{}\n", sets.values.size(), fmt::join(sets.keys, ", "),
               looked_at < sets.values.size()
                   ? fmt::format("; the first {} were looked at", looked_at)
                   : "");
  if (refused > 0 && !options.quiet)
    fmt::print(stderr, "warning: {} of them cannot be used; the first is run {}: {}\n", refused,
               first, reason);
}

}  // namespace repose::app
