#include "app/commands/sweep.hpp"

#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "app/commands/chart.hpp"
#include "input/program_identity.hpp"
#include "input/read_point_test.hpp"
#include "input/read_scene.hpp"
#include "input/resolved_scene.hpp"
#include "input/shipped_input.hpp"
#include "io/json.hpp"
#include "models/instruction_set.hpp"
#include "report/picture/parameter_sweep_picture.hpp"
#include "repose_version.hpp"
#include "study/point/point_sweep.hpp"
#include "study/run/finished_result.hpp"
#include "study/run/run_record.hpp"
#include "study/run/scene_sweep.hpp"

namespace repose::app {
namespace {

using io::Json;

/// Every run, read and checked before the first is begun: `read` fills a case from the file with
/// what the run sets. One that cannot be used is a row of the table; if none can, the first one's
/// mistakes are the file's.
/// seconds: after so many no further run is read.
template <class Case, class Read>
std::vector<Case> cases_of(const input::InputFile& file, const input::ParameterSets& sets,
                           const Read& read, double seconds = HUGE_VAL) {
  std::vector<Case> cases;
  std::size_t refused = 0;
  const double begun = study::usage().wall_s;
  for (std::size_t k = 0; k < sets.values.size(); ++k) {
    if (k > 0 && study::usage().wall_s - begun > seconds) break;
    Case& one = cases.emplace_back();
    one.values = sets.shown(k);
    try {
      input::InputFile run = file.with(sets.sets(k));
      read(one, run, k + 1);
    } catch (const input::BadInput& error) {
      one.refusal = fmt::format("{}", fmt::join(error.problems(), "; "));
      ++refused;
    }
  }
  if (refused == cases.size())
    throw input::BadInput({fmt::format("{}: [sweep]: none of its {} runs can be used; the first:",
                                       to_string(file.origin("sweep")), cases.size()),
                           cases.front().refusal});
  return cases;
}

/// The file with what the command line changed, so that it makes the same sweep again.
std::string text_of(const input::InputFile& file, const std::string& origin) {
  toml::table table = file.root();
  if (toml::table* sweep = table["sweep"].as_table())
    if (const auto name = (*sweep)["table"].value<std::string>())
      sweep->insert_or_assign("table", std::filesystem::absolute(
                                           std::filesystem::path(file.name()).parent_path() / *name)
                                           .lexically_normal()
                                           .string());
  std::ostringstream text;
  text << "# The input of this sweep, by repose " << input::program_identity() << ".\n# " << origin
       << "\n"
       << table << "\n";
  return std::move(text).str();
}

/// What both kinds of sweep do around their runs.
class SweepFolder {
 public:
  SweepFolder(const std::string& path, const input::InputFile& file, const CommonOptions& options)
      : options_(options),
        before_(study::usage()),
        name_(std::filesystem::path(file.name()).stem().string()),
        folder_(options.output.empty() ? io::ResultFolder::default_path(name_)
                                       : std::filesystem::path(options.output)),
        claim_(folder_),
        input_(text_of(file, origin_line(path, options))) {}

  const io::ResultFolder& folder() const { return folder_; }
  const std::string& name() const { return name_; }

  /// Is there nothing left to do?
  bool is_kept() const {
    if (!options_.resume || !study::is_finished(folder_, input_)) return false;
    if (!options_.quiet) fmt::print("{}: finished before; kept\n", folder_.path().string());
    return true;
  }
  /// Does an interrupted one of the same input go on? If not, its files are removed.
  bool begin() const {
    const bool goes_on = options_.resume && study::text_of(folder_.file("input.toml")) == input_;
    if (!goes_on) folder_.remove_old_outputs();
    folder_.remove_old_parts();
    std::error_code ignored;
    std::filesystem::remove(folder_.file("manifest.json"), ignored);
    folder_.write_file("input.toml", input_);
    return goes_on;
  }
  bool draw(const std::function<report::Figure()>& figure) const {
    return !options_.no_plot && drawn(figure, folder_.file("sweep.svg"));
  }
  /// Writes summary.json, tells the outcome, and returns the exit code. reasons: of the runs that
  /// are not done, by their number.
  template <class Sweep>
  io::ExitCode end(const Sweep& sweep, io::ExitCode code, Json further,
                   const std::vector<std::pair<std::size_t, std::string>>& reasons,
                   const std::string& files) const {
    const bool interrupted = code == io::ExitCode::interrupted;
    const std::size_t done = sweep.count("done"), failed = sweep.count("failed"),
                      refused = sweep.count("refused"), runs = sweep.cases().size();
    const study::Usage after = study::usage();
    Json summary{{"repose", version_string},
                 {"instruction_set", std::string(instruction_set())},
                 {"kind", "sweep"},
                 {"name", name_},
                 {"status", interrupted ? "interrupted" : "done"},
                 {"runs", runs},
                 {"runs_done", done},
                 {"runs_failed", failed},
                 {"runs_refused", refused},
                 {"wall_s", after.wall_s - before_.wall_s},
                 {"cpu_s", after.cpu_s - before_.cpu_s}};
    summary.update(further);
    folder_.write_file("summary.json", summary.dump(2) + "\n");
    if (!interrupted) {
      std::filesystem::remove(folder_.file("finished.jsonl"));
      folder_.seal();
    }
    if (options_.json) {
      fmt::print("{}\n", summary.dump());
    } else if (!options_.quiet) {
      fmt::print("{}: {} runs in {:.3g} s{}{}; {}\n", folder_.path().string(),
                 done + failed + refused, after.wall_s - before_.wall_s,
                 failed > 0 ? fmt::format(", {} failed", failed) : "",
                 refused > 0 ? fmt::format(", {} refused", refused) : "", files);
      if (!reasons.empty())
        fmt::print(stderr, "warning: run {}: {}\n", reasons.front().first, reasons.front().second);
      if (reasons.size() > 1)
        fmt::print(stderr, "warning: {} further runs are not done; sweep.csv says why\n",
                   reasons.size() - 1);
    }
    if (interrupted) {
      fmt::print(stderr,
                 "interrupted after {} of {} runs; the same command with --resume continues\n",
                 done + failed + refused, runs);
      return code;
    }
    return done == 0 ? io::ExitCode::numerical_failure : io::ExitCode::done;
  }

 private:
  const CommonOptions& options_;
  study::Usage before_;
  std::string name_;
  io::ResultFolder folder_;
  io::FolderClaim claim_;
  std::string input_;
};

}  // namespace

io::ExitCode run_point_sweep(const std::string& path, const input::InputFile& file,
                             const input::ParameterSets& sets, const CommonOptions& options) {
  const SweepFolder at(path, file, options);
  study::PointSweep sweep(
      sets.keys, cases_of<study::PointCase>(
                     file, sets, [](study::PointCase& one, input::InputFile& run, std::size_t) {
                       one.test = input::read_point_test(run);
                     }));
  if (at.is_kept()) return io::ExitCode::done;
  const io::ExitCode code = sweep.run(at.folder(), options.threads, at.begin());
  at.folder().write_file("sweep.csv", sweep.table());
  const bool drawn = code == io::ExitCode::done && at.draw([&] {
    return report::point_sweep_picture(sweep, at.name(), at.folder().file("curves.csv"));
  });
  std::vector<std::pair<std::size_t, std::string>> reasons;
  for (std::size_t k = 0; k < sweep.finished().size(); ++k)
    if (sweep.finished()[k].status != "done")
      reasons.emplace_back(k + 1, sweep.finished()[k].reason);
  return at.end(sweep, code, Json{{"runs_kept", sweep.kept()}, {"driving_s", sweep.driving_s()}},
                reasons, drawn ? "sweep.csv, curves.csv, sweep.svg" : "sweep.csv, curves.csv");
}

io::ExitCode run_scene_sweep(const std::string& path, const input::InputFile& file,
                             const input::ParameterSets& sets, const CommonOptions& options) {
  const SweepFolder at(path, file, options);
  study::SceneSweep sweep(
      sets.keys,
      cases_of<study::SceneCase>(
          file, sets, [&](study::SceneCase& one, input::InputFile& run, std::size_t number) {
            const std::string name = study::SceneSweep::folder_name(number);
            one.file = input::read_scene(run);
            one.file->scene.name += "_" + name;
            one.input = input::resolved_input(*one.file, fmt::format("Run {} of {}", name, path));
          }));
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
  std::vector<std::pair<std::size_t, std::string>> reasons;
  for (std::size_t k = 0; k < sweep.cases().size(); ++k)
    if (const study::RunSummary& s = sweep.cases()[k].summary;
        !s.status.empty() && s.status != "done")
      reasons.emplace_back(k + 1, s.reason);
  return at.end(sweep, code, Json::object(), reasons,
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
    look(cases_of<study::SceneCase>(
        input::open_scene(path, options.sets), sets,
        [](study::SceneCase&, input::InputFile& run, std::size_t) { input::read_scene(run); },
        seconds));
  else
    look(cases_of<study::PointCase>(
        input::open_test(path, options.sets), sets,
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
