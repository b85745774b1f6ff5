#include "study/sensitivity/sensitivity.hpp"

#include <algorithm>

#include "app/commands/sweep_folder.hpp"
#include "input/file_kind.hpp"
#include "input/read_sensitivity.hpp"
#include "input/shipped_input.hpp"
#include "report/picture/sensitivity_picture.hpp"

namespace repose::app {
namespace {

/// From the runs to what they say.
class SensitivityRun {
 public:
  SensitivityRun(const std::string& path, const input::InputFile& file,
                 const study::SensitivityPlan& plan, const CommonOptions& options)
      : at_("sensitivity", "samples.csv", fmt::format("{}, seed {}", path, options.seed), file,
            options),
        plan_(plan),
        options_(options) {}

  io::ExitCode of_tests(const input::InputFile& file) {
    study::PointSweep sweep(file, plan_.sets, "sensitivity");
    if (at_.is_kept()) return io::ExitCode::done;
    const io::ExitCode code = sweep.run(at_.folder(), options_.threads, at_.begin(), false);
    return end(sweep, code, [&] { return study::outputs_of(sweep, plan_); });
  }

  io::ExitCode of_scenes(const input::InputFile& file) {
    study::SceneSweep sweep(file, plan_.sets, "sensitivity", false);
    const auto usable = std::find_if(sweep.cases().begin(), sweep.cases().end(),
                                     [](const auto& one) { return one.file.has_value(); });
    study::require_outputs(plan_.asked.outputs, study::output_names(*usable->file),
                           plan_.asked.output_place);
    if (at_.is_kept()) return io::ExitCode::done;
    at_.begin();
    std::size_t told = 0;
    // each run knows its own input: also after a change of [sensitivity] those there are are kept
    const io::ExitCode code = sweep.run_side_by_side(
        at_.folder(), options_.threads, options_.seed, options_.resume, [&](std::size_t run) {
          if (options_.quiet || options_.json) return;
          fmt::print("[{}/{}] run {} {}\n", ++told, sweep.cases().size(), run,
                     sweep.cases()[run - 1].summary.status);
          std::fflush(stdout);
        });
    return end(sweep, code, [&] {
      return study::outputs_of(sweep, plan_.asked.outputs, at_.folder().file("runs"));
    });
  }

 private:
  template <class Sweep, class Outputs>
  io::ExitCode end(const Sweep& sweep, io::ExitCode code, const Outputs& outputs) {
    at_.folder().write_file("samples.csv", sweep.table());
    if (code != io::ExitCode::done || sweep.count("done") == 0)
      return at_.end(sweep.counts(), code, io::Json::object(), "samples.csv");
    const Eigen::MatrixXd values = outputs();
    const std::vector<study::OutputSensitivity> found = study::sensitivities(plan_, values);
    const io::Json json = study::sensitivity_json(plan_, found);
    at_.folder().write_file("sensitivity.json", json.dump(2) + "\n");
    at_.folder().write_file("sensitivity.csv", study::sensitivity_csv(plan_, found));
    const bool drawn =
        at_.draw([&] { return report::sensitivity_picture(plan_, found, at_.name()); });
    if (!options_.quiet && !options_.json)
      for (const std::string& line : study::sensitivity_words(plan_, found))
        fmt::print("{}\n", line);
    if (!options_.quiet)
      for (const std::string& line : study::lost_words(plan_, values))
        fmt::print(stderr, "warning: {}\n", line);
    return at_.end(sweep.counts(), code, {{"seed", plan_.seed}, {"outputs", json}},
                   drawn ? "sensitivity.json, sensitivity.csv, samples.csv, sensitivity.svg"
                         : "sensitivity.json, sensitivity.csv, samples.csv");
  }

  SweepFolder at_;
  const study::SensitivityPlan& plan_;
  const CommonOptions& options_;
};

}  // namespace

io::ExitCode run_sensitivity(const std::string& from, const input::InputFile& given,
                             const CommonOptions& options) {
  const bool is_scene = input::kind_of(given) == input::FileKind::scene;
  if (!is_scene) input::require_kind(given, input::FileKind::point_test, "sensitivity");
  input::InputFile input = given;
  std::optional<input::SensitivityInput> asked = input::read_sensitivity(input);
  if (!asked) input.report("", "the file has no [sensitivity]: what varies, and what is looked at");
  input.throw_if_bad();
  const study::SensitivityPlan plan(std::move(*asked), options.seed);
  SensitivityRun run(from, given, plan, options);
  return is_scene ? run.of_scenes(given) : run.of_tests(given);
}

Command add_sensitivity(CLI::App& root) {
  Verb verb(root, "sensitivity", "Which inputs the results of a test or a scene depend on");
  verb.footer(
      "Examples:\n"
      "  repose sensitivity data/sensitivity/clay_strength.toml\n"
      "  repose sensitivity data/sensitivity/column_collapse.toml --resume\n"
      "  repose sensitivity FILE.toml --set sensitivity.method=morris --set "
      "sensitivity.samples=10\n"
      "Writes sensitivity.json, sensitivity.csv, samples.csv (a row per run), sensitivity.svg,\n"
      "summary.json and input.toml; of a scene also runs/.");
  const auto options = std::make_shared<CommonOptions>();
  options->seed = 1;
  const auto file = std::make_shared<std::string>();
  verb.required("FILE.toml", *file, "A point test or a scene with a [sensitivity]", "");
  add_run_options(verb, *options);
  return {verb.app(), options, [options, file] {
            return run_sensitivity(*file, input::open_input(*file, options->sets), *options);
          }};
}

}  // namespace repose::app
