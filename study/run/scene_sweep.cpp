#include "study/run/scene_sweep.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "input/resolved_scene.hpp"
#include "io/interrupt.hpp"
#include "io/number_text.hpp"
#include "io/result_folder.hpp"

namespace repose::study {

SceneSweep::SceneSweep(const input::InputFile& file, const input::ParameterSets& sets,
                       std::string_view table, bool frames, const std::string& level)
    : keys_(sets.keys),
      level_(level.empty() ? "" : level + " "),
      cases_(cases_of<SceneCase>(
          file, sets, table, [&](SceneCase& one, input::InputFile& run, std::size_t number) {
            const std::string name = folder_name(number);
            one.file = input::read_scene(run);
            one.file->scene.name += (level.empty() ? "_" : "_" + level + "_") + name;
            if (!frames) one.file->scene.frame_interval = 0.0;
            one.input = input::resolved_input(
                *one.file, fmt::format("Run {} of {}{}", name, level_, file.name()));
          })) {}

std::string SceneSweep::folder_name(std::size_t run) { return fmt::format("{:04}", run); }

io::ExitCode SceneSweep::run_one(std::size_t k, const io::ResultFolder& folder, int threads,
                                 std::uint64_t seed, bool resume) {
  SceneCase& one = cases_[k];
  if (!one.file) {
    one.summary.status = "refused";
    one.summary.reason = one.refusal;
    return io::ExitCode::done;
  }
  RunRequest request;
  request.file = *one.file;
  request.input = one.input;
  request.folder = folder.file("runs") / folder_name(k + 1);
  request.threads = threads;
  request.seed = seed;
  request.quiet = true;
  const io::ResultFolder there(request.folder);
  if (resume && is_finished(there, one.input)) {
    tidy_finished(there);
  } else {
    request.resume = resume && text_of(there.file("input.toml")) == one.input;
    if (run_scene(request) == io::ExitCode::interrupted) return io::ExitCode::interrupted;
  }
  one.summary = read_summary(there.file("summary.json"));
  return io::ExitCode::done;
}

io::ExitCode SceneSweep::run(const io::ResultFolder& folder, int threads, std::uint64_t seed,
                             bool resume, const std::function<void(std::size_t)>& told) {
  const io::InterruptGuard interrupt;
  for (std::size_t k = 0; k < cases_.size(); ++k) {
    if (interrupt.requested() ||
        run_one(k, folder, threads, seed, resume) == io::ExitCode::interrupted)
      return io::ExitCode::interrupted;
    folder.write_file("sweep.csv", table());
    told(k + 1);
  }
  return io::ExitCode::done;
}

io::ExitCode SceneSweep::run_side_by_side(const io::ResultFolder& folder, int threads,
                                          std::uint64_t seed, bool resume,
                                          const std::function<void(std::size_t)>& told) {
  const io::InterruptGuard interrupt;
  std::atomic<bool> stopped = false;
  std::mutex telling;
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  arena.execute([&] {
    // one run at a time for each thread: the default would hand a thread many in a row
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, cases_.size(), 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t k = range.begin(); k < range.end(); ++k) {
            if (stopped || interrupt.requested()) {
              stopped = true;
              return;
            }
            try {
              if (run_one(k, folder, 1, seed, resume) == io::ExitCode::interrupted) {
                stopped = true;
                return;
              }
            } catch (const InputError& error) {
              cases_[k].summary.status = "refused";
              cases_[k].summary.reason = error.what();
            }
            const std::lock_guard lock(telling);
            told(k + 1);
          }
        },
        tbb::simple_partitioner());
  });
  return stopped ? io::ExitCode::interrupted : io::ExitCode::done;
}

std::string SceneSweep::table() const {
  std::vector<std::string> names;
  for (const SceneCase& one : cases_)
    for (const auto& [name, value] : one.summary.figures)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  std::string text = "run";
  for (const std::string& key : keys_) text += "," + io::csv_cell(key);
  text += ",status";
  for (const std::string& name : names) text += "," + name;
  text += ",reason\n";
  for (std::size_t k = 0; k < cases_.size(); ++k) {
    const SceneCase& one = cases_[k];
    if (one.summary.status.empty()) continue;
    text += fmt::format("{}", k + 1);
    for (const std::string& value : one.values) text += "," + io::csv_cell(value);
    text += "," + one.summary.status;
    for (const std::string& name : names) {
      const auto found = one.summary.figures.find(name);
      text += found == one.summary.figures.end() ? "," : fmt::format(",{}", found->second);
    }
    text += "," + io::csv_cell(one.summary.reason) + "\n";
  }
  return text;
}

std::size_t SceneSweep::count(std::string_view status) const {
  return static_cast<std::size_t>(
      std::count_if(cases_.begin(), cases_.end(),
                    [&](const SceneCase& one) { return one.summary.status == status; }));
}

SweepCounts SceneSweep::counts() const {
  SweepCounts counts;
  for (std::size_t k = 0; k < cases_.size(); ++k)
    counts.add(fmt::format("{}run {}", level_, k + 1), cases_[k].summary.status,
               cases_[k].summary.reason);
  return counts;
}

Eigen::MatrixXd outputs_of(const SceneSweep& sweep, const std::vector<std::string>& names,
                           const std::filesystem::path& runs) {
  using Eigen::Index;
  Eigen::MatrixXd values = Eigen::MatrixXd::Constant(
      static_cast<Index>(sweep.cases().size()), static_cast<Index>(names.size()), std::nan(""));
  for (std::size_t run = 0; run < sweep.cases().size(); ++run) {
    const RunSummary& summary = sweep.cases()[run].summary;
    if (summary.status != "done") continue;
    std::optional<NumberTable> series;
    for (std::size_t k = 0; k < names.size(); ++k) {
      double& value = values(static_cast<Index>(run), static_cast<Index>(k));
      if (const auto figure = summary.figures.find(names[k]); figure != summary.figures.end()) {
        value = figure->second;
        continue;
      }
      if (!series) series = read_numbers(runs / SceneSweep::folder_name(run + 1) / "series.csv");
      if (const auto column = series->find(names[k]);
          column != series->end() && !column->second.empty())
        value = column->second.back();
    }
  }
  return values;
}

std::set<std::string> output_names(const input::SceneFile& scene) {
  const mpm::Simulation simulation(scene.scene, 1);
  const std::vector<std::string> columns = series_columns(scene.scene);
  std::set<std::string> names(columns.begin(), columns.end());
  const io::Json summary =
      io::Json::parse(summary_text({}, RunRecord(simulation), simulation, {1.0}));
  for (const io::Json::Member& figure : summary.items())
    if (figure.value.is_number()) names.insert(figure.key);
  return names;
}

}  // namespace repose::study
