#include "app/commands/check.hpp"

#include <cmath>
#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "app/commands/chart.hpp"
#include "app/commands/sweep.hpp"
#include "input/file_kind.hpp"
#include "input/read_benchmark.hpp"
#include "input/read_chart_set.hpp"
#include "input/read_fit.hpp"
#include "input/read_point_test.hpp"
#include "input/read_scene.hpp"
#include "input/read_sensitivity.hpp"
#include "input/read_stability.hpp"
#include "input/shipped_input.hpp"
#include "io/atomic_file.hpp"
#include "io/json.hpp"
#include "io/number_text.hpp"
#include "io/progress.hpp"
#include "mpm/study/estimate.hpp"
#include "report/picture/scene_picture.hpp"
#include "report/plot/gnuplot.hpp"

namespace repose::app {
namespace {

/// 192 x 90
std::string cells_of(const mpm::Scene& scene) {
  std::string text;
  for (std::size_t k = 0; k < scene.dimensions(); ++k)
    text += fmt::format("{}{}", k > 0 ? " x " : "", std::lround(scene.domain[k] / scene.h));
  return text;
}

void tell(const std::vector<std::string>& warnings, const CommonOptions& options) {
  if (options.quiet) return;
  for (const std::string& warning : warnings) fmt::print(stderr, "warning: {}\n", warning);
}

void draw(const mpm::Scene& scene, const mpm::Estimate& estimate, int threads,
          const std::filesystem::path& path) {
  std::optional<mpm::Simulation> start;
  if (estimate.measured) start.emplace(scene, threads);
  try {
    report::scene_picture(scene, estimate, start ? &*start : nullptr).render_svg(path);
  } catch (const report::PlotError& error) {
    throw io::IoError(path, error.what());  // what was asked for cannot be written
  }
}

io::ExitCode check_scene(input::InputFile& input, const CommonOptions& options, Looks looks,
                         const std::string& picture) {
  const input::SceneFile file = input::read_scene(input);
  const mpm::Scene& scene = file.scene;
  mpm::Estimate estimate;
  try {
    estimate = looks == Looks::measure ? mpm::estimate(scene, options.threads)
                                       : mpm::count_estimate(scene);
  } catch (const InputError& error) {
    input.report(error);
    input.throw_if_bad();
  }
  if (!picture.empty()) draw(scene, estimate, options.threads, picture);
  std::vector<std::string> warnings = file.notes;
  warnings.insert(warnings.end(), estimate.warnings.begin(), estimate.warnings.end());
  if (options.json) {
    io::Json report{{"file", input.name()},
                    {"kind", "scene"},
                    {"name", scene.name},
                    {"points", estimate.points},
                    {scene.dimensions() == 3 ? "volume_m3" : "volume_m3_per_m", estimate.volume},
                    {"live_cells", estimate.live_cells},
                    {"first_dt_s", estimate.first_dt_s},
                    {"steps", estimate.steps},
                    {"memory_MB", estimate.memory_MB},
                    {"wall_s", estimate.seconds},
                    {"warnings", warnings}};
    if (!picture.empty()) report["picture"] = picture;
    fmt::print("{}\n", report.dump());
    return io::ExitCode::done;
  }
  if (!options.quiet)
    fmt::print(
        "{}: a sound scene, \"{}\"\n"
        "  points      {}\n"
        "  volume      {:.6g} m³{}\n"
        "  live cells  {} of {} at the start\n"
        "  first step  {:.3g} s{}\n"
        "  steps       about {} for {:g} s\n"
        "  memory      about {:.2g} MB\n"
        "  run time    about {}\n",
        input.name(), scene.name, io::grouped(static_cast<double>(estimate.points)),
        estimate.volume, scene.dimensions() == 3 ? "" : " per m",
        io::grouped(static_cast<double>(estimate.live_cells)), cells_of(scene), estimate.first_dt_s,
        scene.dt ? ", fixed" : "", io::grouped(io::two_digits(estimate.steps)), scene.end_time,
        estimate.memory_MB,
        io::duration_text(estimate.seconds < 10.0 ? io::two_digits(estimate.seconds)
                                                  : estimate.seconds));
  if (!options.quiet && !picture.empty()) fmt::print("  picture     {}\n", picture);
  tell(warnings, options);
  return io::ExitCode::done;
}

/// "modified_cam_clay, v-ln_p"
std::string law_title(const LawSpec& law) {
  const LawInfo& info = find_law(law);
  return fmt::format("{}, {}", info.name, info.option);
}

/// How the measured tables were understood, below what else is told of a file.
void print_tables(const std::vector<std::string>& tables) {
  for (const std::string& table : tables) {
    std::string text = "  table " + table;
    for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1))
      text.insert(at + 1, "    ");
    fmt::print("{}\n", text);
  }
}

io::ExitCode check_point_test(input::InputFile& input, const CommonOptions& options) {
  const input::PointTestFile file = input::read_point_test(input);
  if (!options.quiet)
    fmt::print(
        "{}: a sound point test, \"{}\"\n"
        "  law          {}\n"
        "  stages       {}\n"
        "  integration  {}\n",
        input.name(), file.name, law_title(file.law), file.test.path.legs.size(),
        point::name_of(point::method_for(find_law(file.law), file.test.settings.method)));
  if (!options.quiet) print_tables(input.tables());
  tell(file.notes, options);
  return io::ExitCode::done;
}

io::ExitCode check_fit(const std::string& path, const CommonOptions& options) {
  const input::FitFile file = input::read_fit(path, options.sets, options.seed);
  if (!options.quiet)
    fmt::print(
        "{}: a sound fit, \"{}\"\n"
        "  law              {}\n"
        "  free parameters  {}\n"
        "  targets          {}\n",
        path, file.name, law_title(file.law), file.free.size(), file.targets.size());
  if (!options.quiet) print_tables(file.tables);
  tell(file.notes, options);
  return io::ExitCode::done;
}

io::ExitCode check_stability(input::InputFile& input, const CommonOptions& options) {
  const input::StabilityInput file = input::read_stability(input);
  std::vector<std::string_view> parts;
  for (const input::StabilityPart part : file.parts)
    parts.push_back(input::stability_names[static_cast<std::size_t>(part)]);
  if (!options.quiet)
    fmt::print("{}: sound stability maps\n  parts  {}\n", input.name(), fmt::join(parts, ", "));
  return io::ExitCode::done;
}

io::ExitCode check_benchmark(input::InputFile& input, const CommonOptions& options) {
  const input::Benchmark file = input::read_benchmark(input);
  double seconds = 0.0;
  std::vector<std::string> laws;
  for (const input::BenchmarkLaw& law : file.laws) {
    laws.emplace_back(input::benchmark_columns[law.column]);
    for (const input::SceneFile& scene : law.scenes)
      seconds += mpm::count_estimate(scene.scene).seconds;
  }
  if (options.quiet) return io::ExitCode::done;
  fmt::print("{}: a sound validation case, \"{}\"\n  laws     {}\n  figures  {}\n", input.name(),
             file.title, fmt::join(laws, ", "), file.figures.size());
  if (file.is_scene())
    fmt::print("  runs     {}, about {}\n", file.laws.size() * file.cells.size(),
               io::duration_text(io::two_digits(seconds)));
  print_tables(input.tables());
  return io::ExitCode::done;
}

io::ExitCode check_charts(const std::string& path, const CommonOptions& options) {
  const std::vector<std::string> lines = check_chart_set(options, path);
  if (!options.quiet)
    fmt::print("{}: a sound set of charts\n  {}\n", path, fmt::join(lines, "\n  "));
  return io::ExitCode::done;
}

}  // namespace

io::ExitCode check_file(const std::string& path, const CommonOptions& options, Looks looks,
                        const std::string& picture) {
  input::InputFile input = input::open_input(path, options.sets);
  if (!picture.empty()) {
    input::require_kind(input, input::FileKind::scene, "check --picture");
    if (std::filesystem::is_directory(picture))
      throw io::IoError(picture, "--picture takes the name of a file, and this is a folder");
    std::error_code none;  // of a scene that goes by its name there is no file here
    if (std::filesystem::equivalent(path, picture, none))
      throw io::IoError(picture, "--picture would take the place of the scene itself");
  }
  if (input::is_chart_set(input)) return check_charts(path, options);
  const input::FileKind kind = input::kind_of(input);
  if (kind == input::FileKind::scene || kind == input::FileKind::point_test) {
    // read on a copy: what it holds besides is read below
    input::InputFile copy = input.with({});
    if (const std::optional<input::ParameterSets> sweep = input::read_sweep(copy)) {
      copy.throw_if_bad();
      check_sweep(path, *sweep, kind == input::FileKind::scene, options);
    }
    if (const auto asked = input::read_sensitivity(copy)) {
      copy.throw_if_bad();
      if (!options.quiet)
        fmt::print("  sensitivity  {} runs of {} inputs\n", asked->runs(), asked->inputs.size());
    }
  }
  switch (kind) {
    case input::FileKind::scene:
      return check_scene(input, options, looks, picture);
    case input::FileKind::point_test:
      return check_point_test(input, options);
    case input::FileKind::fit:
      return check_fit(path, options);
    case input::FileKind::stability:
      return check_stability(input, options);
    case input::FileKind::benchmark:
      return check_benchmark(input, options);
  }
  return io::ExitCode::bad_input;
}

Command add_check(CLI::App& root) {
  Verb verb(root, "check", "Validate an input file, and tell what running it will take");
  verb.footer(
      "Examples:\n"
      "  repose check data/scenes/flat_mu_i.toml\n"
      "  repose check data/scenes/flat_mu_i.toml --set grid.h=0.003125\n"
      "  repose check silo --picture silo.svg\n"
      "  repose check data/experiments/weald_clay_undrained.toml\n"
      "  repose check data/charts/all.toml");
  const auto options = std::make_shared<CommonOptions>();
  const auto file = std::make_shared<std::string>();
  verb.required("FILE.toml", *file,
                "Input file, or the name of a scene or point test, as in flat_mu_i", "");
  const auto picture = std::make_shared<std::string>();
  verb.option("--picture", *picture, "Draw the scene as it starts into this file", "FILE.svg");
  add_set(verb, *options);
  add_threads(verb, *options);
  add_quiet(verb, *options);
  return {verb.app(), options, [options, file, picture] {
            return check_file(*file, *options, Looks::measure, *picture);
          }};
}

}  // namespace repose::app
