#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/commands/chart.hpp"
#include "app/exact_flow.hpp"
#include "app/file_kind.hpp"
#include "app/finished_result.hpp"
#include "app/interrupt.hpp"
#include "app/mpm_sweep.hpp"
#include "app/mpm_sweep_picture.hpp"
#include "app/mpm_sweep_report.hpp"
#include "app/plot/gnuplot.hpp"
#include "app/resolved_input.hpp"
#include "app/result_folder.hpp"
#include "app/run_record.hpp"
#include "app/shipped_input.hpp"
#include "repose_version.hpp"

namespace repose::app {
namespace {

using Json = nlohmann::ordered_json;

/// Pictures are drawn again while runs are still to come, at most so often.
constexpr double seconds_between_pictures = 10.0;

InputFile scene_input(const std::string& file, const std::vector<std::string>& sets) {
  return open_scene(file.empty() ? "flat_mu_i" : file, sets);
}

class MpmChart {
 public:
  MpmChart(const CommonOptions& options, const std::string& file, bool quick)
      : options_(options),
        input_(scene_input(file, options.sets)),
        threads_(options.threads > 0 ? options.threads : 1) {
    require_kind(input_, FileKind::scene, "chart mpm");
    const ChartTable chart = read_chart(input_);
    scene_ = read_scene(input_);
    sweep_ = with_defaults(chart.sweep, scene_.scene, quick || chart.quick, scene_.notes);
    try {
      if (sweep_.exact) exact_shares(*sweep_.exact, scene_.scene, Quantity::kinetic);
      runs_ = runs_of(variants_of(file), sweep_);
    } catch (const InputError& error) {
      input_.report(error);
      input_.throw_if_bad();
    }
  }

  std::size_t runs() const { return runs_.size(); }

  ChartEnd run() {
    const ResultFolder folder(options_.output.empty() ? ResultFolder::default_path("chart_mpm")
                                                      : std::filesystem::path(options_.output));
    const std::string input =
        resolved_input(scene_, origin_line(input_.name(), options_)) + chart_text(sweep_);
    if (options_.resume && is_finished(folder, input)) return {ExitCode::done, true};
    folder.remove_old_outputs();
    folder.write_file("input.toml", input);
    if (!options_.quiet && !options_.json)
      for (const std::string& note : scene_.notes) fmt::print(stderr, "warning: {}\n", note);
    const Usage before = usage();
    double drawn = before.wall_s;
    std::string status = "done";
    std::size_t count = 0;
    const InterruptGuard interrupt;
    for (SweepRun& run : runs_) {
      if (interrupt.requested() ||
          carry_out(run, folder.file("runs"), threads_, options_.resume) == ExitCode::interrupted) {
        status = "interrupted";
        break;
      }
      ++count;
      folder.write_file("chart.csv", sweep_csv(runs_));
      tell(run, count);
      if (count < runs_.size() && usage().wall_s - drawn > seconds_between_pictures) {
        write_outcome(folder);
        drawn = usage().wall_s;
      }
    }
    const std::vector<std::string> files = write_outcome(folder);
    const auto sound =
        std::count_if(runs_.begin(), runs_.end(), [](const SweepRun& run) { return run.done(); });
    if (sound == 0 && status == "done") status = "failed";
    const std::optional<SweepReference> reference = known_reference();
    const Json answer = sweep_answer(series_of(runs_));
    const Json errors = reference ? errors_answer(runs_, *reference) : Json(nullptr);
    write_summary(folder, status, static_cast<std::size_t>(sound), answer, errors, before);
    if (!options_.quiet && !options_.json)
      fmt::print("{}, from the longest step to the shortest:\n{}{}{}: {}\n", scene_.scene.name,
                 answer_text(answer),
                 reference ? errors_text(errors)
                           : "no reference: three cell sizes of one transfer and kernel make one\n",
                 folder.path().string(), fmt::join(files, ", "));
    if (status == "interrupted") {
      if (!options_.quiet && !options_.json)
        fmt::print(stderr,
                   "interrupted after {} of {} runs; the same command with --resume "
                   "continues\n",
                   count, runs_.size());
      return {ExitCode::interrupted};
    }
    return {status == "failed" ? ExitCode::numerical_failure : ExitCode::done};
  }

 private:
  /// The scene with every combination of what [chart.vary] lists.
  std::vector<SceneVariant> variants_of(const std::string& file) const {
    std::vector<SceneVariant> variants{{scene_, {}}};
    for (const VariedKey& varied : sweep_.vary) {
      std::vector<SceneVariant> more;
      for (const SceneVariant& variant : variants)
        for (const std::string& value : varied.values) {
          SceneVariant next = variant;
          next.values.emplace_back(varied.key, value);
          std::vector<std::string> sets = options_.sets;
          for (const auto& [key, text] : next.values)
            sets.push_back(fmt::format("{}={}", key, text));
          InputFile input = scene_input(file, sets);
          read_chart(input);
          next.file = read_scene(input);
          more.push_back(std::move(next));
        }
      variants = std::move(more);
    }
    return variants;
  }

  std::optional<SweepReference> known_reference() const {
    return sweep_.exact ? exact_reference(runs_, *sweep_.exact) : reference_of(runs_, scene_.scene);
  }

  /// Tables and pictures of what there is so far; returns their names.
  std::vector<std::string> write_outcome(const ResultFolder& folder) const {
    folder.write_file("history.csv", history_csv(runs_));
    std::vector<std::string> files{"chart.csv", "history.csv"};
    const std::optional<SweepReference> reference = known_reference();
    if (reference) {
      folder.write_file("errors.csv", errors_csv(runs_, *reference));
      files.push_back("errors.csv");
      for (const Quantity q : {Quantity::profile, Quantity::kinetic, Quantity::momentum}) {
        const auto& value = reference->values[static_cast<std::size_t>(q)];
        if (!value) continue;
        files.push_back(fmt::format("reference_{}.csv", name_of(q)));
        folder.write_file(files.back(),
                          curve_csv(value->value, q, runs_.front().scene(), common_bin(runs_)));
      }
    }
    if (std::any_of(runs_.begin(), runs_.end(), [](const SweepRun& run) { return run.done(); }))
      draw(folder, series_of(runs_), reference, files);
    return files;
  }

  void tell(const SweepRun& run, std::size_t count) const {
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

  void draw(const ResultFolder& folder, const std::vector<SweepSeries>& series,
            const std::optional<SweepReference>& reference, std::vector<std::string>& files) const {
    const std::string name =
        fmt::format("{} to {:.4g} s", scene_.scene.name, scene_.scene.end_time);
    const auto render = [&](const Figure& figure, const std::string& file) {
      try {
        figure.render_svg(folder.file(file));
        files.push_back(file);
      } catch (const PlotError& error) {
        fmt::print(stderr, "warning: no {}: {}\n", file, error.what());
      } catch (const std::logic_error& error) {  // nothing to draw
        fmt::print(stderr, "warning: no {}: {}\n", file, error.what());
      }
    };
    if (reference && reference->exact) {
      render(flow_figure(runs_, *reference, name), "chart.svg");
    } else {
      render(step_figure(series, name), "chart.svg");
      render(history_figure(series, name), "history.svg");
    }
    if (sweep_.cells.size() > 1) render(cost_figure(series, name), "cost.svg");
    if (reference) render(work_precision_figure(runs_, *reference, name), "work_precision.svg");
  }

  void write_summary(const ResultFolder& folder, const std::string& status, std::size_t sound,
                     const Json& answer, const Json& errors, const Usage& before) const {
    const Usage after = usage();
    Json summary{{"repose", version_string},
                 {"kind", "chart_mpm"},
                 {"status", status},
                 {"name", scene_.scene.name},
                 {"seed", options_.seed},
                 {"runs", runs_.size()},
                 {"runs_done", sound},
                 {"threads", threads_},
                 {"wall_s", after.wall_s - before.wall_s},
                 {"cpu_s", after.cpu_s - before.cpu_s},
                 {"allowed_change", allowed_change},
                 {"answer", answer},
                 {"errors", errors},
                 {"warnings", warnings()}};
    folder.write_file("summary.json", summary.dump(2) + "\n");
    if (options_.json) fmt::print("{}\n", summary.dump());
  }

  /// Of the runs, each with its name.
  std::vector<std::string> warnings() const {
    std::vector<std::string> list = scene_.notes;
    for (const SweepRun& run : runs_) {
      if (run.status().empty()) continue;
      for (const std::string& warning : run.summary.warnings)
        list.push_back(fmt::format("{}: {}", run.scene().name, warning));
      if (run.status() == "failed")
        list.push_back(fmt::format("{}: failed: {}", run.scene().name, run.summary.reason));
    }
    return list;
  }

  const CommonOptions& options_;
  InputFile input_;
  int threads_;
  SceneFile scene_;
  Sweep sweep_;
  std::vector<SweepRun> runs_;
};

}  // namespace

ChartEnd chart_mpm(const CommonOptions& options, const std::string& file, bool quick) {
  return MpmChart(options, file, quick).run();
}

std::size_t check_chart_mpm(const CommonOptions& options, const std::string& file, bool quick) {
  return MpmChart(options, file, quick).runs();
}

}  // namespace repose::app
