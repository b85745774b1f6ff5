#include <cmath>

#include <fmt/format.h>

#include "app/commands/chart.hpp"
#include "input/file_kind.hpp"
#include "input/resolved_scene.hpp"
#include "input/shipped_input.hpp"
#include "io/interrupt.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "models/instruction_set.hpp"
#include "report/picture/sweep_picture.hpp"
#include "repose_version.hpp"
#include "study/accuracy/exact_flow.hpp"
#include "study/accuracy/sweep.hpp"
#include "study/accuracy/sweep_report.hpp"
#include "study/run/finished_result.hpp"
#include "study/run/run_record.hpp"

namespace repose::app {
namespace {

using Json = io::Json;

/// Pictures are drawn again while runs are still to come, at most so often.
constexpr double seconds_between_pictures = 10.0;

input::InputFile scene_input(const std::string& file, const std::vector<std::string>& sets) {
  return input::open_scene(file.empty() ? "flat_mu_i" : file, sets);
}

class MpmChart {
 public:
  MpmChart(const CommonOptions& options, const std::string& file, bool quick)
      : options_(options),
        input_(scene_input(file, options.sets)),
        threads_(options.threads > 0 ? options.threads : 1) {
    input::require_kind(input_, input::FileKind::scene, "chart mpm");
    const input::ChartTable chart = input::read_chart(input_);
    scene_ = input::read_scene(input_);
    sweep_ = study::with_defaults(chart.sweep, scene_.scene, quick || chart.quick, scene_.notes);
    try {
      if (sweep_.exact) study::exact_shares(*sweep_.exact, scene_.scene, study::Quantity::kinetic);
      runs_ = study::runs_of(variants_of(file), sweep_);
    } catch (const InputError& error) {
      input_.report(error);
      input_.throw_if_bad();
    }
  }

  std::size_t runs() const { return runs_.size(); }

  ChartEnd run() {
    const io::ResultFolder folder(options_.output.empty()
                                      ? io::ResultFolder::default_path("chart_mpm")
                                      : std::filesystem::path(options_.output));
    const std::string input = input::resolved_input(scene_, origin_line(input_.name(), options_)) +
                              input::chart_text(sweep_);
    const io::FolderClaim claim(folder);
    if (options_.resume && study::is_finished(folder, input)) return {io::ExitCode::done, true};
    folder.remove_old_outputs();
    folder.write_file("input.toml", input);
    if (!options_.quiet && !options_.json)
      for (const std::string& note : scene_.notes) fmt::print(stderr, "warning: {}\n", note);
    const study::Usage before = study::usage();
    double drawn = before.wall_s;
    std::string status = "done";
    std::size_t count = 0;
    const io::InterruptGuard interrupt;
    for (study::SweepRun& run : runs_) {
      if (interrupt.requested() || study::carry_out(run, folder.file("runs"), threads_,
                                                    options_.resume) == io::ExitCode::interrupted) {
        status = "interrupted";
        break;
      }
      ++count;
      folder.write_file("chart.csv", study::sweep_csv(runs_));
      tell(run, count);
      if (count < runs_.size() && study::usage().wall_s - drawn > seconds_between_pictures) {
        write_outcome(folder);
        drawn = study::usage().wall_s;
      }
    }
    const std::vector<std::string> files = write_outcome(folder);
    const auto sound = std::count_if(runs_.begin(), runs_.end(),
                                     [](const study::SweepRun& run) { return run.done(); });
    if (sound == 0 && status == "done") status = "failed";
    const std::optional<study::SweepReference> reference =
        study::reference_of(runs_, scene_.scene, sweep_);
    const Json answer = study::sweep_answer(study::series_of(runs_));
    const Json errors = reference ? study::errors_answer(runs_, *reference) : Json(nullptr);
    write_summary(folder, status, static_cast<std::size_t>(sound), answer, errors, before);
    if (!options_.quiet && !options_.json)
      fmt::print("{}, from the longest step to the shortest:\n{}{}{}: {}\n", scene_.scene.name,
                 study::answer_text(answer),
                 reference ? study::errors_text(errors)
                           : "no reference: three cell sizes of one transfer and kernel make one\n",
                 folder.path().string(), fmt::join(files, ", "));
    if (status == "interrupted") {
      if (!options_.quiet && !options_.json)
        fmt::print(stderr,
                   "interrupted after {} of {} runs; the same command with --resume "
                   "continues\n",
                   count, runs_.size());
      return {io::ExitCode::interrupted};
    }
    return {status == "failed" ? io::ExitCode::numerical_failure : io::ExitCode::done};
  }

 private:
  /// The scene with every combination of what [chart.vary] lists.
  std::vector<study::SceneVariant> variants_of(const std::string& file) const {
    std::size_t count = 1;
    for (const input::VariedKey& varied : sweep_.vary) {
      count *= varied.values.size();
      if (count > study::most_chart_scenes)
        throw InputError("chart.vary", fmt::format("chart.vary makes more than {} scenes",
                                                   study::most_chart_scenes));
    }
    std::vector<study::SceneVariant> variants{{scene_, {}}};
    for (const input::VariedKey& varied : sweep_.vary) {
      std::vector<study::SceneVariant> more;
      for (const study::SceneVariant& variant : variants)
        for (const std::string& value : varied.values) {
          study::SceneVariant next = variant;
          next.values.emplace_back(varied.key, value);
          std::vector<std::string> sets = options_.sets;
          for (const auto& [key, text] : next.values)
            sets.push_back(fmt::format("{}={}", key, text));
          input::InputFile input = scene_input(file, sets);
          input::read_chart(input);
          next.file = input::read_scene(input);
          more.push_back(std::move(next));
        }
      variants = std::move(more);
    }
    return variants;
  }

  /// Tables and pictures of what there is so far; returns their names.
  std::vector<std::string> write_outcome(const io::ResultFolder& folder) const {
    std::vector<std::string> files{"chart.csv"};
    const std::optional<study::SweepReference> reference =
        study::reference_of(runs_, scene_.scene, sweep_);
    for (const auto& [name, text] : study::outcome_tables(runs_, reference)) {
      folder.write_file(name, text);
      files.push_back(name);
    }
    if (std::any_of(runs_.begin(), runs_.end(),
                    [](const study::SweepRun& run) { return run.done(); }))
      draw(folder, study::series_of(runs_), reference, files);
    return files;
  }

  void tell(const study::SweepRun& run, std::size_t count) const {
    if (options_.json)
      fmt::print("{}\n", Json{{"event", "run"},
                              {"name", run.scene().name},
                              {"run", count},
                              {"runs", runs_.size()},
                              {"status", run.status()},
                              {"front_m", run.figure("front_m")},
                              {"cpu_s", run.figure("cpu_s")}}
                             .dump());
    else if (!options_.quiet)
      fmt::print("[{}/{}] {}: {}, front {:.4f} m, {:.2f} s of CPU\n", count, runs_.size(),
                 run.scene().name, run.status(), run.figure("front_m"), run.figure("cpu_s"));
    std::fflush(stdout);
  }

  void draw(const io::ResultFolder& folder, const std::vector<study::SweepSeries>& series,
            const std::optional<study::SweepReference>& reference,
            std::vector<std::string>& files) const {
    const std::string name =
        fmt::format("{} to {:.4g} s", scene_.scene.name, scene_.scene.end_time);
    const auto render = [&](const report::Figure& figure, const std::string& file) {
      if (!options_.no_plot && drawn(figure, folder.file(file))) files.push_back(file);
    };
    if (reference && reference->exact) {
      render(report::flow_figure(runs_, *reference, name), "chart.svg");
    } else {
      render(report::step_figure(series, name), "chart.svg");
      render(report::history_figure(series, name), "history.svg");
    }
    if (sweep_.cells.size() > 1) render(report::cost_figure(series, name), "cost.svg");
    if (reference)
      render(report::work_precision_figure(runs_, *reference, name), "work_precision.svg");
  }

  void write_summary(const io::ResultFolder& folder, const std::string& status, std::size_t sound,
                     const Json& answer, const Json& errors, const study::Usage& before) const {
    const study::Usage after = study::usage();
    Json summary{{"repose", version_string},
                 {"instruction_set", std::string(instruction_set())},
                 {"kind", "chart_mpm"},
                 {"status", status},
                 {"name", scene_.scene.name},
                 {"seed", options_.seed},
                 {"runs", runs_.size()},
                 {"runs_done", sound},
                 {"threads", threads_},
                 {"wall_s", after.wall_s - before.wall_s},
                 {"cpu_s", after.cpu_s - before.cpu_s},
                 {"allowed_change", study::allowed_change},
                 {"answer", answer},
                 {"errors", errors},
                 {"warnings", warnings()}};
    folder.write_file("summary.json", summary.dump(2) + "\n");
    folder.seal();
    if (options_.json) fmt::print("{}\n", summary.dump());
  }

  std::vector<std::string> warnings() const {
    std::vector<std::string> list = scene_.notes;
    for (std::string& warning : study::warnings_of(runs_)) list.push_back(std::move(warning));
    return list;
  }

  const CommonOptions& options_;
  input::InputFile input_;
  int threads_;
  input::SceneFile scene_;
  input::Sweep sweep_;
  std::vector<study::SweepRun> runs_;
};

}  // namespace

ChartEnd chart_mpm(const CommonOptions& options, const std::string& file, bool quick) {
  return MpmChart(options, file, quick).run();
}

std::size_t check_chart_mpm(const CommonOptions& options, const std::string& file, bool quick) {
  return MpmChart(options, file, quick).runs();
}

}  // namespace repose::app
