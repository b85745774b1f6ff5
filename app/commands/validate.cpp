#include <algorithm>

#include <fmt/format.h>

#include "app/commands/chart.hpp"
#include "input/file_kind.hpp"
#include "input/shipped_input.hpp"
#include "io/json.hpp"
#include "report/page/validation_page.hpp"
#include "report/picture/validation_picture.hpp"
#include "repose_version.hpp"
#include "study/run/run_record.hpp"
#include "study/validation/validation_record.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;
using Json = io::Json;
using study::CaseResult;

struct ValidateArguments {
  CommonOptions common;
  std::vector<std::string> cases, columns;
  bool coarse = false;
};

study::ValidationOptions options_of(const ValidateArguments& arguments) {
  study::ValidationOptions options{
      arguments.common.threads, arguments.common.resume, arguments.coarse, {}};
  for (const std::string& name : arguments.columns)
    options.columns.push_back(input::benchmark_column(name));
  return options;
}

class Validation {
 public:
  explicit Validation(const ValidateArguments& arguments)
      : arguments_(arguments),
        asked_(options_of(arguments)),
        folder_(arguments.common.output.empty() ? io::ResultFolder::default_path("validate")
                                                : fs::path(arguments.common.output)),
        claim_(folder_) {
    std::vector<std::string> names = arguments.cases;
    if (names.empty())
      for (const std::string_view name : input::shipped_benchmarks()) names.emplace_back(name);
    std::vector<std::string> problems;
    for (const std::string& name : names) try {
        input::InputFile file = input::InputFile::read(input::find_benchmark(name, folder_.path()));
        input::require_kind(file, input::FileKind::benchmark, "validate");
        cases_.emplace_back(input::read_benchmark(file, arguments.common.sets), asked_);
        const std::string& now = cases_.back().benchmark.name;
        for (std::size_t k = 0; k + 1 < cases_.size(); ++k)
          if (cases_[k].benchmark.name == now)
            problems.push_back(fmt::format("{}: there are two cases called '{}'", name, now));
      } catch (const input::BadInput& error) {
        problems.insert(problems.end(), error.problems().begin(), error.problems().end());
      }
    if (names.empty()) problems.emplace_back("no case is given, and the program holds none");
    if (!problems.empty()) throw input::BadInput(std::move(problems));
  }

  io::ExitCode run() {
    folder_.remove_old_outputs();
    folder_.write_file("input.toml",
                       study::validation_input(cases_, asked_, arguments_.common.sets));
    for (CaseResult& result : cases_) {
      const io::ResultFolder there(folder_.file(result.benchmark.name));
      there.remove_old_outputs();
      const io::ExitCode code = study::run_case(
          result, there.path(), asked_, [&](std::size_t column) { tell_law(result, column); });
      there.write_file("result.csv", study::result_csv(result));
      if (!arguments_.common.no_plot && result.cpu_s() > 0.0)
        drawn([&] { return report::validation_picture(result); }, there.file("result.svg"));
      write_page(code == io::ExitCode::interrupted ? "interrupted" : "running");
      if (code == io::ExitCode::interrupted) {
        if (!arguments_.common.quiet)
          fmt::print(stderr, "interrupted; the same command with --resume continues\n");
        return code;
      }
    }
    return finish();
  }

 private:
  void tell_law(const CaseResult& result, std::size_t column) const {
    const study::LawResult& law = result.laws[column];
    const std::string_view name = input::benchmark_columns[column];
    if (arguments_.common.json)
      fmt::print("{}\n", Json{{"event", "law"},
                              {"case", result.benchmark.name},
                              {"law", name},
                              {"verdict", study::verdict_words(law)},
                              {"cpu_s", law.cpu_s}}
                             .dump());
    else if (!arguments_.common.quiet)
      fmt::print("{:<24} {:<12} {}, {:.3g} s of CPU{}\n", result.benchmark.name, name,
                 study::verdict_words(law), law.cpu_s,
                 study::shared_reason(law).empty() ? "" : ": " + study::shared_reason(law));
    std::fflush(stdout);
  }

  Json write_page(const std::string& status) const {
    std::string note;
    if (asked_.coarse) note = "Quick look: the coarsest cells alone, without error bars.";
    if (!arguments_.common.sets.empty())
      note += fmt::format("{}With {}.", note.empty() ? "" : " ",
                          fmt::join(arguments_.common.sets, ", "));
    folder_.write_file("validation.md",
                       report::validation_page(cases_, note, !arguments_.common.no_plot));
    const Json summary = study::validation_json(cases_, status, asked_, arguments_.common.sets);
    folder_.write_file("summary.json", summary.dump(2) + "\n");
    return summary;
  }

  io::ExitCode finish() const {
    std::size_t failed = 0;
    for (const CaseResult& result : cases_) failed += result.count(study::Verdict::failed);
    const Json summary = write_page(failed > 0 ? "failed" : "done");
    folder_.seal();
    if (arguments_.common.json)
      fmt::print("{}\n", summary.dump());
    else if (!arguments_.common.quiet)
      fmt::print("\n{}\n{}: validation.md, summary.json, and per case result.csv, result.svg\n",
                 report::validation_table(cases_), folder_.path().string());
    if (failed > 0)
      fmt::print(stderr, "{} figures have no value; validation.md says why\n", failed);
    return failed > 0 ? io::ExitCode::numerical_failure : io::ExitCode::done;
  }

  const ValidateArguments& arguments_;
  study::ValidationOptions asked_;
  io::ResultFolder folder_;
  io::FolderClaim claim_;
  std::vector<CaseResult> cases_;
};

}  // namespace

Command add_validate(CLI::App& root) {
  Verb verb(root, "validate", "Compare laws with experiments and exact solutions");
  verb.footer(
      "Examples:\n"
      "  repose validate                          every case that comes with the program\n"
      "  repose validate collapse_rods --law mu_i --coarse\n"
      "  repose validate --resume                 after an interruption (Ctrl-C)\n"
      "Writes validation.md, and per case result.csv and result.svg. Runs that are there already\n"
      "are not repeated. Returns 3 if a figure has no value, 0 whatever the verdicts are.");
  const auto arguments = std::make_shared<ValidateArguments>();
  CommonOptions& options = arguments->common;
  verb.option("CASE", arguments->cases, "Names of shipped cases, or folders with a case.toml", "");
  verb.option("-o,--output", options.output, "Result folder (default: results/validate)", "DIR");
  verb.repeated("--law", arguments->columns,
                fmt::format("Only this column of the page: {}; may be repeated",
                            fmt::join(input::benchmark_columns, ", ")),
                "COLUMN");
  verb.flag("--coarse", arguments->coarse,
            "Only the coarsest cells of each case, without error bars");
  verb.repeated("--set", options.sets, "Override a key of every scene and test; may be repeated",
                "KEY=VALUE");
  add_threads(verb, options);
  verb.flag("--resume", options.resume, "Go on with interrupted runs from their checkpoints");
  add_no_plot(verb, options);
  add_quiet(verb, options);
  return {verb.app(), std::shared_ptr<const CommonOptions>(arguments, &arguments->common),
          [arguments] { return Validation(*arguments).run(); }};
}

}  // namespace repose::app
