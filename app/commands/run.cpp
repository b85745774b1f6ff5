#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "app/accurate_run.hpp"
#include "app/commands/command.hpp"
#include "app/commands/sweep.hpp"
#include "input/file_kind.hpp"
#include "input/resolved_scene.hpp"
#include "input/shipped_input.hpp"
#include "io/result_folder.hpp"
#include "report/picture/heap_picture.hpp"
#include "study/run/run_scene.hpp"

namespace repose::app {
namespace {

/// What `repose run` takes beside the options of every run.
struct RunArguments {
  CommonOptions common;
  std::string file;
  std::optional<double> accuracy, budget;
  std::string quantity, runs;
};

/// What --accuracy chooses cannot be set as well.
void refuse_chosen_keys(const CommonOptions& options) {
  for (const char* const key :
       {"grid.h", "grid.kernel", "step.transfer", "step.courant", "step.dt"})
    for (const std::string& set : options.sets)
      if (set.starts_with(std::string(key) + "="))
        throw input::BadInput({fmt::format("--set {}: --accuracy chooses {} itself", set, key)});
}

io::ExitCode run_accurately(const RunArguments& arguments) {
  const CommonOptions& options = arguments.common;
  AccuracyRequest request;
  const std::string& quantity = arguments.quantity;
  if (quantity.empty())
    throw input::BadInput(
        {fmt::format("--accuracy needs --for, one of {}", fmt::join(study::advised_names, ", "))});
  const auto named = std::find(study::advised_names.begin(), study::advised_names.end(), quantity);
  if (named == study::advised_names.end()) {
    const std::string near =
        input::closest(quantity, {study::advised_names.begin(), study::advised_names.end()});
    throw input::BadInput({fmt::format(
        "--for {}: one of {} is needed{}", quantity, fmt::join(study::advised_names, ", "),
        near.empty() ? "" : fmt::format("; did you mean '{}'?", near))});
  }
  request.quantity = static_cast<study::Quantity>(named - study::advised_names.begin());
  const auto number = [](const char* name, double x, double upper, const char* meaning) {
    if (!(x > 0.0) || !(x <= upper))
      throw input::BadInput(
          {fmt::format("--{} {}: {} must be a number in (0, {}]", name, x, meaning, upper)});
    return x;
  };
  request.target = number("accuracy", *arguments.accuracy, 0.5, "the relative error");
  if (arguments.budget) request.budget = number("budget", *arguments.budget, 1e9, "CPU seconds");
  refuse_chosen_keys(options);
  input::InputFile input = input::open_scene(arguments.file, options.sets);
  input::require_kind(input, input::FileKind::scene, "run");
  request.file = input::read_scene(input);
  request.origin = origin_line(arguments.file, options);
  request.folder = options.output.empty()
                       ? io::ResultFolder::default_path(request.file.scene.name + "_accuracy")
                       : std::filesystem::path(options.output);
  request.runs =
      arguments.runs.empty() ? request.folder / "runs" : std::filesystem::path(arguments.runs);
  request.threads = options.threads > 0 ? options.threads : 1;
  request.seed = options.seed;
  request.resume = options.resume;
  request.quiet = options.quiet;
  request.json = options.json;
  request.picture = !options.no_plot;
  return run_to_accuracy(request);
}

io::ExitCode run_file(const RunArguments& arguments) {
  const CommonOptions& options = arguments.common;
  const std::string& path = arguments.file;
  if (arguments.accuracy) return run_accurately(arguments);
  for (const auto& [given, option] : {std::pair{arguments.budget.has_value(), "--budget"},
                                      {!arguments.quantity.empty(), "--for"},
                                      {!arguments.runs.empty(), "--runs"}})
    if (given)
      throw input::BadInput({fmt::format("{} goes with --accuracy, which is missing", option)});
  return run_scene(path, input::open_scene(path, options.sets), options);
}

}  // namespace

io::ExitCode run_scene(const std::string& from, const input::InputFile& given,
                       const CommonOptions& options) {
  input::require_kind(given, input::FileKind::scene, "run");
  input::InputFile input = given;
  if (const std::optional<input::ParameterSets> sweep = input::read_sweep(input)) {
    input.throw_if_bad();
    return run_scene_sweep(from, given, *sweep, options);
  }
  study::RunRequest request;
  request.file = input::read_scene(input);
  request.input = input::resolved_input(request.file, origin_line(from, options));
  request.folder = options.output.empty() ? io::ResultFolder::default_path(request.file.scene.name)
                                          : std::filesystem::path(options.output);
  request.threads = options.threads;
  request.seed = options.seed;
  request.resume = options.resume;
  if (!options.no_plot) request.picture = report::draw_final_picture;
  request.quiet = options.quiet;
  request.json = options.json;
  try {
    return study::run_scene(request);
  } catch (const InputError& error) {
    input.report(error);
    input.throw_if_bad();
    throw;
  }
}

Command add_run(CLI::App& root) {
  Verb verb(root, "run", "Run a scene");
  verb.footer(
      "Examples:\n"
      "  repose run flat_mu_i                     a scene that comes with the program\n"
      "  repose run MY.toml --set grid.h=0.0125 -o results/coarse\n"
      "  repose run MY.toml --resume              after an interruption (Ctrl-C)\n"
      "  repose run flat_mu_i --accuracy 0.02 --for front_99 --budget 60");
  const auto arguments = std::make_shared<RunArguments>();
  CommonOptions& options = arguments->common;
  verb.required("SCENE", arguments->file,
                fmt::format("A file, or one of {}", fmt::join(input::shipped_scenes(), ", ")), "");
  add_run_options(verb, options);
  verb.option("--accuracy", arguments->accuracy,
              "Relative error to reach, as in 0.02: chooses h, kernel, transfer and step, runs "
              "coarse and fine ones, and gives what they tend to with an error bar",
              "E");
  verb.option("--for", arguments->quantity,
              fmt::format("Of what (with --accuracy): {}", fmt::join(study::advised_names, ", ")),
              "QUANTITY");
  verb.option(
      "--budget", arguments->budget,
      "CPU seconds that --accuracy may take: refuses beforehand what is known to take more, "
      "and stops a run that would",
      "SECONDS");
  verb.option("--runs", arguments->runs,
              "Where the runs of --accuracy lie; those there are not repeated (default: runs/ "
              "in the result folder)",
              "DIR");
  return {verb.app(), std::shared_ptr<const CommonOptions>(arguments, &arguments->common),
          [arguments] { return run_file(*arguments); }};
}

}  // namespace repose::app
