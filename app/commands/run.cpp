#include <filesystem>

#include <fmt/format.h>

#include "app/commands/command.hpp"
#include "app/file_kind.hpp"
#include "app/resolved_input.hpp"
#include "app/result_folder.hpp"
#include "app/run_scene.hpp"

namespace repose::app {
namespace {

ExitCode run_file(const std::string& path, const CommonOptions& options) {
  InputFile input = InputFile::read(path, options.sets);
  require_kind(input, FileKind::scene, "run");
  RunRequest request;
  request.file = read_scene(input);
  request.input = resolved_input(request.file, origin_line(path, options));
  request.folder = options.output.empty() ? ResultFolder::default_path(request.file.scene.name)
                                          : std::filesystem::path(options.output);
  request.threads = options.threads;
  request.seed = options.seed;
  request.resume = options.resume;
  request.quiet = options.quiet;
  request.json = options.json;
  try {
    return run_scene(request);
  } catch (const InputError& error) {
    input.report(error);
    input.throw_if_bad();
    throw;
  }
}

}  // namespace

Command add_run(CLI::App& root) {
  CLI::App* verb = root.add_subcommand("run", "Run a scene");
  verb->footer(
      "Examples:\n"
      "  repose run data/scenes/flat_mu_i.toml\n"
      "  repose run data/scenes/flat_mu_i.toml --set grid.h=0.0125 -o results/coarse\n"
      "  repose run data/scenes/flat_mu_i.toml --resume     after an interruption (Ctrl-C)");
  const auto options = std::make_shared<CommonOptions>();
  const auto file = std::make_shared<std::string>();
  verb->add_option("SCENE.toml", *file, "Scene file")->type_name("")->required();
  add_run_options(*verb, *options);
  return {verb, options, [options, file] { return run_file(*file, *options); }};
}

}  // namespace repose::app
