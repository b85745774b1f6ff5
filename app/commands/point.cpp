#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "app/commands/chart.hpp"
#include "app/commands/sweep.hpp"
#include "input/file_kind.hpp"
#include "input/shipped_input.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "report/picture/point_picture.hpp"
#include "repose_version.hpp"
#include "study/point/laboratory_record.hpp"
#include "study/point/test_record.hpp"
#include "study/point/test_result.hpp"
#include "study/run/run_record.hpp"

namespace repose::app {
namespace {

using Json = io::Json;

std::string toml_text(const toml::table& table, const std::string& origin) {
  std::ostringstream text;
  text << "# The input of this result with its defaults, by repose " << version_string << ".\n# "
       << origin << "\n"
       << table << "\n";
  return std::move(text).str();
}

class PointRun {
 public:
  PointRun(const std::string& path, input::InputFile input, const CommonOptions& options)
      : options_(options),
        input_(std::move(input)) {
    file_ = input::read_point_test(input_);
    origin_ = "From " + path;
    for (const std::string& set : options.sets) origin_ += " --set " + set;
    std::replace_if(
        origin_.begin(), origin_.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  }

  io::ExitCode run() {
    const io::ResultFolder folder(options_.output.empty()
                                      ? io::ResultFolder::default_path(file_.name)
                                      : std::filesystem::path(options_.output));
    const io::FolderClaim claim(folder);
    folder.remove_old_outputs();
    const toml::table input = study::resolved_test(input_, file_);
    write(folder, "input.toml", toml_text(input, origin_));
    const study::Usage before = study::usage();
    result_ = study::drive(file_);
    const study::Usage after = study::usage();
    for (std::string& remark : study::remarks(file_, result_))
      file_.notes.push_back(std::move(remark));
    write(folder, "curve.csv", study::curve_csv(file_, result_));
    const Json report =
        study::test_summary(file_, result_, input, after.cpu_s - before.cpu_s, options_.seed);
    write(folder, "summary.json", report.dump(2) + "\n");
    const bool picture =
        !options_.no_plot && !result_.curve.rows.empty() &&
        drawn(
            [&] {
              return report::point_picture(file_, result_.theta, result_.curve,
                                           fmt::format("{}", fmt::join(options_.sets, ", ")));
            },
            folder.file("curve.svg"));
    if (!options_.quiet)
      for (const std::string& note : file_.notes) fmt::print(stderr, "warning: {}\n", note);
    tell(folder, report, picture);
    return result_.failed() ? io::ExitCode::numerical_failure : io::ExitCode::done;
  }

 private:
  /// Not to the disk at once: the test is driven again in less time than that takes.
  static void write(const io::ResultFolder& folder, std::string_view name,
                    const std::string& content) {
    folder.write_file(name, content, io::Outlives::kill);
  }

  void tell(const io::ResultFolder& folder, const Json& report, bool drawn) const {
    const bool failed = result_.failed();
    if (failed) fmt::print(stderr, "{}: {}\n", input_.name(), result_.reason);
    if (options_.json) {
      Json line{{"event", "done"}, {"folder", folder.path().string()}};
      for (const char* key : {"status", "reason", "rows", "wall_s"}) line[key] = report[key];
      fmt::print("{}\n", line.dump());
    } else if (!options_.quiet) {
      fmt::print("{}: {} rows by {} in {:.3g} ms{}; {}\n", folder.path().string(),
                 result_.curve.rows.size(), report["method"].get<std::string>(),
                 1e3 * report["wall_s"].get<double>(), failed ? "" : ", " + result_.reason,
                 drawn ? "curve.csv, curve.svg, summary.json" : "curve.csv, summary.json");
      if (const std::string line = study::laboratory_line(result_.figures); !line.empty())
        fmt::print("{}\n", line);
    }
  }

  CommonOptions options_;
  input::InputFile input_;
  input::PointTestFile file_;
  std::string origin_;
  study::TestResult result_;
};

}  // namespace

io::ExitCode run_test(const std::string& from, const input::InputFile& given,
                      const CommonOptions& options) {
  input::require_kind(given, input::FileKind::point_test, "point");
  input::InputFile input = given;
  const std::optional<input::ParameterSets> sweep = input::read_sweep(input);
  if (sweep) {
    input.throw_if_bad();
    return run_point_sweep(from, given, *sweep, options);
  }
  for (const auto& [is_given, option] :
       {std::pair{options.resume, "--resume"}, {options.threads > 0, "--threads"}})
    if (is_given)
      throw input::BadInput(
          {fmt::format("{} goes with a [sweep], and {} has none", option, given.name())});
  return PointRun(from, given, options).run();
}

Command add_point(CLI::App& root) {
  Verb verb(root, "point", "Drive one material point along a path");
  verb.footer(
      "Examples:\n"
      "  repose point weald_clay_undrained\n"
      "  repose point weald_clay_undrained --set initial.ocr=8 -o results/oc\n"
      "  repose point my_test.toml --set law=results/my_fit/fitted.toml\n"
      "  repose point weald_clay_undrained --set 'sweep.grid={\"initial.ocr\" = [1, 2, 4, 8]}'\n"
      "Writes curve.csv, curve.svg, summary.json and input.toml. A path that cannot be finished\n"
      "leaves the part done and returns 3. With a [sweep]: sweep.csv, curves.csv, sweep.svg.");
  const auto options = std::make_shared<CommonOptions>();
  const auto file = std::make_shared<std::string>();
  verb.required("TEST.toml", *file,
                fmt::format("A file, or one of {}", fmt::join(input::shipped_tests(), ", ")), "");
  verb.option("-o,--output", options->output, "Result folder (default: results/NAME)", "DIR");
  add_set(verb, *options);
  add_threads(verb, *options);
  verb.flag("--resume", options->resume, "Go on with an interrupted [sweep]");
  add_no_plot(verb, *options);
  add_quiet(verb, *options);
  return {verb.app(), options, [options, file] {
            return run_test(*file, input::open_test(*file, options->sets), *options);
          }};
}

}  // namespace repose::app
