#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "app/commands/chart.hpp"
#include "io/interrupt.hpp"
#include "io/json.hpp"
#include "io/progress.hpp"
#include "io/result_folder.hpp"
#include "report/picture/comparison_picture.hpp"
#include "report/picture/fit_picture.hpp"
#include "report/picture/posterior_picture.hpp"
#include "study/fit/comparison_record.hpp"
#include "study/fit/journal.hpp"
#include "study/fit/posterior_record.hpp"
#include "study/fit/search.hpp"
#include "study/run/run_record.hpp"

namespace repose::app {
namespace {

using Json = io::Json;

class FitRun {
 public:
  FitRun(const input::InputFile& input, const FitArguments& arguments, const CommonOptions& options)
      : arguments_(arguments),
        options_(options),
        source_(input.name()),
        output_(options.output.empty() ? io::ResultFolder::default_path(name())
                                       : std::filesystem::path(options.output)),
        file_(input::read_fit(input, options.seed, output_ / "runs")),
        problem_(calibration::ParameterSpace(file_.free), file_.targets, file_.balance, file_.loss),
        folder_(output_) {
    study::share_starts(file_, arguments.starts_from, arguments.starts_to);
    if (file_.posterior)
      study::share_chains(file_, arguments.chains_from, arguments.chains_to,
                          study::have_chains(arguments.merge));
  }

  std::string name() const { return std::filesystem::path(source_).stem().string(); }
  /// Of a fit that has come to an end.
  bool ended_well() const { return !result_.starts.empty() && !result_.best().failed; }
  study::Contender contender() { return {name(), file_, problem_, result_}; }

  io::ExitCode run() {
    const io::FolderClaim claim(folder_);
    std::vector<calibration::StartResult> done =
        study::begin_fit(folder_, file_, source_, arguments_.merge, options_.resume);
    for (const std::string& note : file_.notes)
      if (!options_.quiet) fmt::print(stderr, "note: {}\n", note);

    const study::Usage before = study::usage();
    std::optional<tbb::global_control> threads;
    if (options_.threads > 0)
      threads.emplace(tbb::global_control::max_allowed_parallelism,
                      static_cast<std::size_t>(options_.threads));
    const io::InterruptGuard interrupt;
    const std::size_t told = file_.notes.size();
    study::Solution solution =
        study::solve(file_, problem_,
                     {std::move(done), !arguments_.merge.empty(),
                      [&] { return interrupt.requested(); }, [&](const auto& s) { after(s); }});
    result_ = std::move(solution.result);
    const std::string& status = solution.status;
    const Json& report = solution.report;
    const bool interrupted = status == "interrupted";
    if (result_.starts.empty()) {
      write_summary(status, before, {});
      fmt::print(stderr, "{}: no start came to an end\n", source_);
      return interrupted ? io::ExitCode::interrupted : io::ExitCode::numerical_failure;
    }
    for (std::size_t k = told; k < file_.notes.size() && !options_.quiet; ++k)
      fmt::print(stderr, "note: {}\n", file_.notes[k]);
    study::write_fit(folder_, file_, problem_, result_, report);
    draw("fit.svg", [&] { return report::fit_picture(file_, problem_, result_); });
    draw("fit_diagnostics.svg", [&] { return report::fit_diagnostics(file_, result_); });
    tell(status, study::usage().wall_s - before.wall_s);
    bool sampled = true;
    if (file_.posterior && !interrupted && !result_.best().failed) {
      problem_.interrupt_by([&] { return interrupt.requested(); });
      sampled = sample();
    }
    write_summary(sampled ? status : "interrupted", before, report);
    if (interrupted || !sampled) return io::ExitCode::interrupted;
    const bool converged = result_.converged && posterior_.converged;
    const bool short_of = arguments_.strict && !converged;
    return result_.best().failed || short_of ? io::ExitCode::numerical_failure : io::ExitCode::done;
  }

 private:
  /// Called under run_starts' lock: appends the start, whole, so that a kill loses none before it.
  void after(const calibration::StartResult& s) {
    const std::filesystem::path path = folder_.file(study::starts_name);
    if (!study::append(path, study::journal_line(s))) write_error_ = path.string();
    if (options_.json)
      fmt::print("{}\n", Json{{"event", "start"},
                              {"start", s.index},
                              {"objective", s.optimum.objective},
                              {"why", s.optimum.why}}
                             .dump());
  }

  /// Draws the posterior around the best end. False if it was interrupted.
  bool sample() {
    const study::Usage before = study::usage();
    const study::Sampler sampler(file_, problem_, result_.best().z);
    const std::filesystem::path own = folder_.file(study::chains_name);
    std::vector<calibration::Draw> done =
        study::begin_sampling(folder_, file_, sampler, arguments_.merge, options_.resume);
    posterior_ = study::sample(file_, sampler, {std::move(done), [&](const calibration::Draw& d) {
                                                  if (!study::append(own, study::journal_line(d)))
                                                    write_error_ = own.string();
                                                }});
    if (posterior_.complete) {
      study::write_posterior(folder_, file_, sampler, posterior_);
      draw("posterior_bands.svg",
           [&] { return report::posterior_bands_picture(file_, posterior_); });
      draw("posterior_corner.svg",
           [&] { return report::posterior_corner_picture(file_, posterior_); });
    }
    const double seconds = study::usage().wall_s - before.wall_s;
    say(Json{{"event", "posterior"},
             {"draws", posterior_.kept},
             {"divergent", posterior_.divergent},
             {"converged", posterior_.converged},
             {"wall_s", seconds}},
        "  posterior in " + io::duration_text(seconds), study::posterior_words(file_, posterior_));
    return posterior_.complete || !problem_.interrupted();
  }

  void write_summary(const std::string& status, const study::Usage& before, const Json& report) {
    if (!write_error_.empty())
      throw io::IoError(write_error_, "cannot append to the journal of starts");
    const Json s = study::fit_summary(file_, status, before, report);
    folder_.write_file("summary.json", s.dump(2) + "\n");
    folder_.seal();
  }

  void draw(const char* name, const std::function<report::Figure()>& figure) const {
    if (!options_.no_plot) drawn(figure, folder_.file(name));
  }

  void tell(const std::string& status, double seconds) const {
    say(Json{{"event", "done"},
             {"folder", folder_.path().string()},
             {"status", status},
             {"objective", result_.best().objective},
             {"wall_s", seconds}},
        fmt::format("{}: {}, objective {:.6g} from {} starts in {}", folder_.path().string(),
                    status, result_.best().objective, result_.starts.size(),
                    io::duration_text(seconds)),
        study::fit_words(file_, problem_, result_));
  }

  void say(const Json& event, const std::string& head,
           const std::vector<std::string>& lines) const {
    if (options_.json) fmt::print("{}\n", event.dump());
    if (options_.json || options_.quiet) return;
    fmt::print("{}\n", head);
    for (const std::string& line : lines) fmt::print("  {}\n", line);
  }

  FitArguments arguments_;
  CommonOptions options_;
  std::string source_;
  std::filesystem::path output_;
  input::FitFile file_;
  calibration::Problem problem_;
  io::ResultFolder folder_;
  study::FitResult result_;
  study::PosteriorResult posterior_;
  std::string write_error_;
};

/// Every fit in a folder of its own, and what tells them apart.
io::ExitCode compare_fits(const std::vector<input::InputFile>& inputs,
                          const FitArguments& arguments, const CommonOptions& options) {
  const bool shared = !arguments.merge.empty() || arguments.starts_from > 0 ||
                      arguments.starts_to >= 0 || arguments.chains_from > 0 ||
                      arguments.chains_to >= 0;
  if (shared)
    throw input::BadInput(
        {"--compare takes whole fits: share out each alone, and --merge it into "
         "the folder that --compare --resume then takes up"});
  std::vector<input::FitFile> files;
  for (const input::InputFile& one : inputs) files.push_back(input::read_fit(one, options.seed));
  study::check_same_data(files);
  const io::ResultFolder folder(options.output.empty()
                                    ? io::ResultFolder::default_path(study::comparison_name(files))
                                    : std::filesystem::path(options.output));
  const io::FolderClaim claim(folder);
  std::vector<std::unique_ptr<FitRun>> runs;
  std::vector<study::Contender> contenders;
  io::ExitCode code = io::ExitCode::done;
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    CommonOptions own = options;
    own.output = folder.file(files[k].name).string();
    runs.push_back(std::make_unique<FitRun>(inputs[k], arguments, own));
    const io::ExitCode end = runs.back()->run();
    if (end == io::ExitCode::interrupted || !runs.back()->ended_well()) return end;
    if (end != io::ExitCode::done) code = end;
    contenders.push_back(runs.back()->contender());
  }
  const io::InterruptGuard interrupt;
  for (const study::Contender& c : contenders)
    c.problem.interrupt_by([&] { return interrupt.requested(); });
  bool written = true;
  const std::filesystem::path journal = folder.file(study::left_out_name);
  const study::Comparison comparison = study::compare(
      contenders, {study::begin_comparison(folder, contenders, options.resume),
                   [&](const study::LeftOutFit& fit) {
                     written = study::append(journal, study::journal_line(fit)) && written;
                   }});
  if (!written) throw io::IoError(journal, "cannot append to the journal of tests left out");
  if (!comparison.complete) return io::ExitCode::interrupted;
  study::write_comparison(folder, comparison);
  if (!options.no_plot)
    drawn([&] { return report::comparison_picture(comparison); }, folder.file("comparison.svg"));
  folder.seal();
  if (options.json)
    fmt::print("{}\n", Json{{"event", "comparison"},
                            {"folder", folder.path().string()},
                            {"verdict", study::verdict(comparison)}}
                           .dump());
  else if (!options.quiet)
    fmt::print("{}\n", fmt::join(study::comparison_words(comparison), "\n"));
  return code;
}

}  // namespace

io::ExitCode run_fit(const input::InputFile& input, const FitArguments& arguments,
                     const CommonOptions& options) {
  return FitRun(input, arguments, options).run();
}

Command add_fit(CLI::App& root) {
  Verb verb(root, "fit", "Fit a law's parameters to experiments");
  verb.footer(
      "Examples:\n"
      "  repose fit data/experiments/fit_kaolin.toml\n"
      "  repose fit FIT.toml --set solver.starts=64 -o results/wide --resume\n"
      "  repose fit FIT.toml --starts-from 0 --starts-to 32 -o shard0     one share of a campaign\n"
      "  repose fit FIT.toml --merge shard0 shard1 -o whole               all shares as one "
      "result\n"
      "  repose fit FIT.toml --posterior                                  draws of all that the "
      "data leave open\n"
      "  repose fit A.toml B.toml --compare -o which                      which law, on the same "
      "tests\n"
      "Writes fit.json, fitted.toml (a [law] table), predictions.csv, fit.svg,\n"
      "fit_diagnostics.svg, starts.jsonl, summary.json and input.toml; with a posterior\n"
      "posterior.json, posterior.csv, posterior_bands.csv, posterior_bands.svg,\n"
      "posterior_corner.svg and chains.jsonl. --compare writes each into a folder of its name,\n"
      "and comparison.json, comparison.csv, unseen.csv, comparison.svg and left_out.jsonl.");
  const auto options = std::make_shared<CommonOptions>();
  options->seed = 1;
  const auto files = std::make_shared<std::vector<std::string>>();
  const auto arguments = std::make_shared<FitArguments>();
  constexpr int most_starts = std::numeric_limits<int>::max();
  verb.required("FIT.toml", *files, "Fit file; several with --compare", "");
  add_run_options(verb, *options);
  verb.integer("--starts-from", arguments->starts_from, 0, most_starts, "First start of this share",
               "I");
  verb.integer("--starts-to", arguments->starts_to, 1, most_starts,
               "One past the last start of this share", "J");
  verb.flag("--posterior", arguments->posterior,
            "Draw from the posterior, as [posterior] says or by default");
  verb.integer("--chains-from", arguments->chains_from, 0, most_starts,
               "First chain of this share of the posterior", "I");
  verb.integer("--chains-to", arguments->chains_to, 1, most_starts,
               "One past the last chain of this share", "J");
  verb.flag(
      "--compare", arguments->compare,
      "Which of several fits to the same tests: a result for each, and what tells them apart");
  verb.flag("--strict", arguments->strict, "Exit with 3 if the fit is not converged");
  verb.option("--merge", arguments->merge,
              "Take the starts, and the chains, from these result folders", "DIR...");
  return {verb.app(), options, [options, files, arguments] {
            std::vector<input::InputFile> given;
            for (const std::string& file : *files) {
              given.push_back(input::InputFile::read(file, options->sets));
              if (!arguments->posterior || given.back().root().contains("posterior")) continue;
              const std::vector<std::string> table{
                  fmt::format("posterior.chains={}", calibration::PosteriorOptions{}.chains)};
              given.back() = given.back().with(table);
            }
            if (arguments->compare == (given.size() > 1))
              return arguments->compare ? compare_fits(given, *arguments, *options)
                                        : run_fit(given.front(), *arguments, *options);
            throw input::BadInput({arguments->compare ? "--compare takes two fit files or more"
                                                      : "several fit files are for --compare"});
          }};
}

}  // namespace repose::app
