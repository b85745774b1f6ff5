#include "app/commands/sweep_folder.hpp"
#include "input/file_kind.hpp"
#include "input/shipped_input.hpp"
#include "report/picture/propagation_picture.hpp"

namespace repose::app {
namespace {

struct PropagateArguments {
  std::string fit, scene;
  study::PropagationOptions options;
  std::optional<double> coarsen;
  CommonOptions common;
};

io::ExitCode run_propagate(const PropagateArguments& given) {
  const CommonOptions& common = given.common;
  const input::InputFile file = input::open_input(given.scene, common.sets);
  input::require_kind(file, input::FileKind::scene, "propagate");
  input::InputFile read = file;
  const input::SceneFile scene = input::read_scene(read);
  const study::FittedPosterior posterior = study::read_posterior(given.fit);
  const study::PropagationPlan plan = study::plan_propagation(posterior, scene, given.options);
  study::require_outputs(plan.asked.outputs, study::output_names(scene), "--for");
  study::SceneSweep coarse(file, plan.coarse_sets, "scene", false, "coarse"),
      fine(file, plan.fine_sets, "scene", false, "fine");
  const SweepFolder at(
      "propagation", "draws.csv", given.scene, file, common,
      fmt::format("Posterior of {} ({}), {} runs, {} fine, cells {} times as wide, {}",
                  posterior.name, posterior.fingerprint, plan.asked.runs, plan.asked.fine,
                  plan.asked.coarsen, fmt::join(plan.asked.outputs, " ")));
  if (at.is_kept()) return io::ExitCode::done;
  for (const std::string& text : plan.warnings)
    if (!common.quiet) fmt::print(stderr, "warning: {}\n", text);
  at.begin();
  std::size_t told = 0;
  const auto run = [&](study::SceneSweep& sweep, const char* level) {
    return sweep.run_side_by_side(io::ResultFolder(at.folder().file(level)), common.threads,
                                  common.seed, common.resume, [&](std::size_t k) {
                                    if (common.quiet || common.json) return;
                                    fmt::print("[{}/{}] {} run {} {}\n", ++told,
                                               plan.draws.size() + plan.fine.size(), level, k,
                                               sweep.cases()[k - 1].summary.status);
                                    std::fflush(stdout);
                                  });
  };
  io::ExitCode code = run(fine, "fine");  // the long ones first
  if (code == io::ExitCode::done) code = run(coarse, "coarse");

  study::SweepCounts counts = coarse.counts();
  counts += fine.counts();
  if (code != io::ExitCode::done) return at.end(counts, code, io::Json::object(), "");
  const study::PropagationResult result = study::propagation(
      plan, coarse, fine, at.folder().file("coarse/runs"), at.folder().file("fine/runs"));
  const io::Json outputs = study::propagation_json(plan, result);
  study::write_propagation(at.folder(), posterior, plan, result);
  const bool drawn = at.draw([&] { return report::propagation_picture(plan, result, at.name()); });
  if (!common.quiet && !common.json)
    for (const std::string& line : study::propagation_words(plan, result)) fmt::print("{}\n", line);
  return at.end(counts, code,
                {{"outputs", outputs}, {"fit", posterior.name}, {"warnings", plan.warnings}},
                drawn ? "propagation.json, propagation.csv, draws.csv, propagation.svg"
                      : "propagation.json, propagation.csv, draws.csv");
}

}  // namespace

Command add_propagate(CLI::App& root) {
  Verb verb(root, "propagate", "What the posterior of a fit leaves open of a scene's results");
  verb.footer(
      "Example:\n"
      "  repose fit data/experiments/fit_glass_beads.toml --posterior -o beads\n"
      "  repose propagate beads data/scenes/flat_mu_i.toml --set grid.h=0.0125 -o run_out\n"
      "Writes propagation.json, propagation.csv, draws.csv, depth_bands.csv (in the plane),\n"
      "propagation.svg, summary.json, input.toml and all runs.");
  const auto arguments = std::make_shared<PropagateArguments>();
  verb.required("FIT_RESULT", arguments->fit, "The folder of a fit with a posterior", "");
  verb.required("SCENE.toml", arguments->scene, "A scene with a body of the fit's law", "");
  study::PropagationOptions& options = arguments->options;
  verb.integer("--runs", options.runs, 4, input::most_sweep_runs,
               "Draws that are run with coarse cells (100)", "N");
  verb.integer("--fine", options.fine, 4, input::most_sweep_runs,
               "Of these, run with the scene's own cells as well (12)", "N");
  verb.option("--coarsen", arguments->coarsen, "Width of coarse cells over the scene's own (2)",
              "RATIO");
  verb.option("--for", options.outputs,
              "Figures of summary.json, or columns of series.csv at the end (front_99_m and "
              "height_m; over terrain runout_99_m and reached_m2)",
              "NAME");
  add_run_options(verb, arguments->common);
  return {verb.app(), std::shared_ptr<CommonOptions>(arguments, &arguments->common), [arguments] {
            arguments->options.coarsen = arguments->coarsen.value_or(arguments->options.coarsen);
            return run_propagate(*arguments);
          }};
}

}  // namespace repose::app
