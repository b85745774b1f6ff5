#include <algorithm>
#include <filesystem>

#include <fmt/core.h>
#include <tbb/global_control.h>

#include "app/commands/command.hpp"
#include "io/interrupt.hpp"
#include "io/json.hpp"
#include "io/progress.hpp"
#include "io/result_folder.hpp"
#include "report/picture/fit_picture.hpp"
#include "report/picture/posterior_picture.hpp"
#include "report/plot/gnuplot.hpp"
#include "repose_version.hpp"
#include "study/fit/journal.hpp"
#include "study/fit/posterior_record.hpp"
#include "study/fit/search.hpp"
#include "study/run/run_record.hpp"

namespace repose::app {
namespace {

using Json = io::Json;

constexpr std::string_view journal_name = "starts.jsonl";
constexpr std::string_view chains_name = "chains.jsonl";

class FitRun {
 public:
  FitRun(const input::InputFile& input, const FitArguments& arguments, const CommonOptions& options)
      : arguments_(arguments),
        options_(options),
        source_(input.name()),
        output_(options.output.empty()
                    ? io::ResultFolder::default_path(std::filesystem::path(source_).stem().string())
                    : std::filesystem::path(options.output)),
        file_(input::read_fit(input, options.seed, output_ / "runs")),
        problem_(calibration::ParameterSpace(file_.free), file_.targets, file_.balance),
        folder_(output_) {
    file_.options.starts_from = arguments.starts_from;
    file_.options.starts_to = arguments.starts_to;
    const int to = arguments.starts_to < 0 ? file_.options.starts : arguments.starts_to;
    if (arguments.starts_from >= to || to > file_.options.starts)
      throw input::BadInput(
          {fmt::format("--starts-from {} --starts-to {}: this fit has starts 0 to {}, and "
                       "--starts-to is the first one that is left out",
                       arguments.starts_from, arguments.starts_to, file_.options.starts)});
    if (file_.posterior)
      study::share_chains(file_, arguments.chains_from, arguments.chains_to,
                          study::have_chains(arguments.merge, chains_name));
  }

  io::ExitCode run() {
    const io::FolderClaim claim(folder_);
    std::vector<std::filesystem::path> journals;
    for (const std::string& dir : arguments_.merge) {
      journals.push_back(std::filesystem::path(dir) / journal_name);
      if (!std::filesystem::exists(journals.back()))
        throw io::IoError(journals.back(),
                          "there is no journal of starts; give result folders of `repose fit`");
    }
    if (options_.resume) journals.push_back(folder_.file(journal_name));
    std::vector<calibration::StartResult> done = study::read_starts(journals, file_);
    // the journal first: a kill in between must not lose the starts that it holds
    folder_.write_file(journal_name, study::starts_journal(file_, done));
    folder_.remove_old_outputs();
    folder_.write_file("input.toml", fmt::format("# The input of this result, by repose {}.\n# "
                                                 "From {}\n{}",
                                                 version_string, source_, file_.resolved));
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
    folder_.write_file("fit.json", report.dump(2) + "\n");
    folder_.write_file("fitted.toml", study::fitted_toml(file_, result_));
    folder_.write_file("predictions.csv", study::predictions_csv(file_, problem_, result_));
    draw();
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
    const std::filesystem::path path = folder_.file(journal_name);
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
    const std::filesystem::path own = folder_.file(chains_name);
    std::vector<std::filesystem::path> journals;
    for (const std::string& dir : arguments_.merge)
      journals.push_back(std::filesystem::path(dir) / chains_name);
    if (options_.resume) journals.push_back(own);
    std::vector<calibration::Draw> done = study::read_chains(journals, sampler);
    folder_.write_file(chains_name, study::chains_journal(file_, sampler, done));
    posterior_ = study::sample(file_, sampler, {std::move(done), [&](const calibration::Draw& d) {
                                                  if (!study::append(own, study::journal_line(d)))
                                                    write_error_ = own.string();
                                                }});
    if (posterior_.complete) {
      study::write_posterior(folder_, file_, sampler, posterior_);
      attempt("posterior_bands.svg",
              [&] { return report::posterior_bands_picture(file_, posterior_); });
      attempt("posterior_corner.svg",
              [&] { return report::posterior_corner_picture(file_, posterior_); });
    }
    tell_posterior(study::usage().wall_s - before.wall_s);
    return posterior_.complete || !problem_.interrupted();
  }

  void tell_posterior(double seconds) const {
    if (options_.json) {
      fmt::print("{}\n", Json{{"event", "posterior"},
                              {"draws", posterior_.kept},
                              {"divergent", posterior_.divergent},
                              {"converged", posterior_.converged},
                              {"wall_s", seconds}}
                             .dump());
      return;
    }
    if (options_.quiet) return;
    fmt::print("  posterior in {}\n", io::duration_text(seconds));
    for (const std::string& line : study::posterior_words(file_, posterior_))
      fmt::print("  {}\n", line);
  }

  void write_summary(const std::string& status, const study::Usage& before, const Json& report) {
    if (!write_error_.empty())
      throw io::IoError(write_error_, "cannot append to the journal of starts");
    const Json s = study::fit_summary(file_, status, before, report);
    folder_.write_file("summary.json", s.dump(2) + "\n");
    folder_.seal();
  }

  /// A picture that cannot be drawn is a warning: the figures are in fit.json.
  template <class Make>
  void attempt(const char* name, Make&& figure) const {
    if (options_.no_plot) return;
    try {
      figure().render_svg(folder_.file(name));
    } catch (const report::PlotError& error) {
      fmt::print(stderr, "warning: no {}: {}\n", name, error.what());
    } catch (const std::logic_error& error) {
      fmt::print(stderr, "warning: no {}: {}\n", name, error.what());
    }
  }

  void draw() const {
    attempt("fit.svg", [&] { return report::fit_picture(file_, problem_, result_); });
    attempt("fit_diagnostics.svg", [&] { return report::fit_diagnostics(file_, result_); });
  }

  void tell(const std::string& status, double seconds) const {
    if (options_.json) {
      fmt::print("{}\n", Json{{"event", "done"},
                              {"folder", folder_.path().string()},
                              {"status", status},
                              {"objective", result_.best().objective},
                              {"wall_s", seconds}}
                             .dump());
      return;
    }
    if (options_.quiet) return;
    fmt::print("{}: {}, objective {:.6g} from {} starts in {}\n", folder_.path().string(), status,
               result_.best().objective, result_.starts.size(), io::duration_text(seconds));
    for (const std::string& line : study::fit_words(file_, problem_, result_))
      fmt::print("  {}\n", line);
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
      "Writes fit.json, fitted.toml (a [law] table), predictions.csv, fit.svg,\n"
      "fit_diagnostics.svg, starts.jsonl, summary.json and input.toml; with a posterior\n"
      "posterior.json, posterior.csv, posterior_bands.csv, posterior_bands.svg,\n"
      "posterior_corner.svg and chains.jsonl.");
  const auto options = std::make_shared<CommonOptions>();
  options->seed = 1;
  const auto file = std::make_shared<std::string>();
  const auto arguments = std::make_shared<FitArguments>();
  constexpr int most_starts = std::numeric_limits<int>::max();
  verb.required("FIT.toml", *file, "Fit file", "");
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
  verb.flag("--strict", arguments->strict, "Exit with 3 if the fit is not converged");
  verb.option("--merge", arguments->merge,
              "Take the starts, and the chains, from these result folders", "DIR...");
  return {verb.app(), options, [options, file, arguments] {
            input::InputFile given = input::InputFile::read(*file, options->sets);
            if (arguments->posterior && !given.root().contains("posterior")) {
              const std::vector<std::string> table{
                  fmt::format("posterior.chains={}", calibration::PosteriorOptions{}.chains)};
              given = given.with(table);
            }
            return run_fit(given, *arguments, *options);
          }};
}

}  // namespace repose::app
