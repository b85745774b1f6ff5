#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "app/commands/command.hpp"
#include "app/commands/sweep.hpp"
#include "input/file_kind.hpp"
#include "input/read_law.hpp"
#include "input/shipped_input.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "models/instruction_set.hpp"
#include "report/picture/point_picture.hpp"
#include "report/plot/gnuplot.hpp"
#include "repose_version.hpp"
#include "study/point/laboratory_record.hpp"
#include "study/point/test_result.hpp"
#include "study/run/run_record.hpp"

namespace repose::app {
namespace {

using Json = io::Json;

/// The input with what the command line changed and the defaults that numbers depend on.
toml::table resolved(const input::InputFile& input, const input::PointTestFile& file) {
  toml::table table = input.root();
  if (!input::own_option_lines(file.law).empty())
    table.insert_or_assign("law", toml::table(toml::parse(input::law_lines(file.law))));
  if (!table.contains("law")) table.insert("law", toml::table{});
  toml::table& law = *table["law"].as_table();
  for (const auto& [key, text] : file.law.options) {
    if (!input::own_option_lines(file.law).empty()) break;  // they stand there already
    if (text == "true" || text == "false")
      law.insert_or_assign(key, text == "true");
    else
      law.insert_or_assign(key, text);
  }
  for (const ParamInfo& parameter : find_law(file.law).parameters) {
    const auto value = file.law.values.find(std::string(parameter.name));
    if (value == file.law.values.end()) continue;
    if (parameter.words.empty())
      law.insert_or_assign(parameter.name, value->second);
    else
      law.insert_or_assign(parameter.name, input::word_of(parameter, value->second));
    if (!parameter.angle.name.empty()) law.erase(parameter.angle.name);  // it has said its own
  }
  const point::Settings& settings = file.test.settings;
  toml::table integration;
  integration.insert(
      "method",
      std::string(point::name_of(point::method_for(find_law(file.law), settings.method))));
  integration.insert("tolerance", settings.tolerance);
  integration.insert("substeps", static_cast<std::int64_t>(settings.substeps));
  integration.insert("max_steps", static_cast<std::int64_t>(settings.max_steps));
  integration.insert("max_strain", settings.max_strain);
  table.insert_or_assign("integration", integration);
  // a result folder lies elsewhere than the file: relative tables are written in full
  if (toml::table* test = table["test"].as_table(); test != nullptr && test->contains("history"))
    if (const auto name = (*test)["history"].value<std::string>())
      test->insert_or_assign(
          "history",
          std::filesystem::absolute(std::filesystem::path(input.name()).parent_path() / *name)
              .lexically_normal()
              .string());
  return table;
}

std::string toml_text(const toml::table& table, const std::string& origin) {
  std::ostringstream text;
  text << "# The input of this result with its defaults, by repose " << version_string << ".\n# "
       << origin << "\n"
       << table << "\n";
  return std::move(text).str();
}

Json json_of(const toml::node& node) {
  std::ostringstream text;
  if (const auto* table = node.as_table())
    text << toml::json_formatter{*table};
  else if (const auto* list = node.as_array())
    text << toml::json_formatter{*list};
  return Json::parse(text.str());
}

/// A number for JSON: what is not finite becomes null.
Json finite_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

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
    const toml::table input = resolved(input_, file_);
    write(folder, "input.toml", toml_text(input, origin_));
    const study::Usage before = study::usage();
    result_ = study::drive(file_);
    const study::Usage after = study::usage();
    for (std::string& remark : study::remarks(file_, result_))
      file_.notes.push_back(std::move(remark));
    write(folder, "curve.csv", study::curve_csv(file_, result_));
    const Json report = summary(input, result_.wall_s, after.cpu_s - before.cpu_s);
    write(folder, "summary.json", report.dump(2) + "\n");
    const bool drawn = draw(folder);
    if (!options_.quiet)
      for (const std::string& note : file_.notes) fmt::print(stderr, "warning: {}\n", note);
    tell(folder, report, drawn);
    return result_.failed() ? io::ExitCode::numerical_failure : io::ExitCode::done;
  }

 private:
  /// Not to the disk at once: the test is driven again in less time than that takes.
  static void write(const io::ResultFolder& folder, std::string_view name,
                    const std::string& content) {
    folder.write_file(name, content, io::Outlives::kill);
  }

  std::vector<double> column(point::Quantity quantity) const {
    std::vector<double> values;
    point::read_column(*result_.law, result_.theta, file_.test, result_.curve, quantity, values);
    return values;
  }

  Json summary(const toml::table& input, double wall, double cpu) const {
    const point::Outcome& o = result_.curve.outcome;
    Json s;
    s["repose"] = version_string;
    s["instruction_set"] = instruction_set();
    s["kind"] = "point_test";
    s["name"] = file_.name;
    s["status"] = result_.failed() ? "failed" : "done";
    s["reason"] = result_.reason;
    s["fraction"] = o.fraction;
    s["method"] = point::name_of(point::method_for(*result_.law, file_.test.settings.method));
    s["tolerance"] = file_.test.settings.tolerance;
    s["strain"] = point::name_of(file_.test.path.measure);
    s["warnings"] = file_.notes;
    s["rows"] = result_.curve.rows.size();
    s["steps"] = o.counts.steps;
    s["steps_rejected"] = o.counts.rejected;
    s["rate_evaluations"] = o.counts.rates;
    s["events"] = o.counts.events;
    if (o.counts.tangents_checked > 0) {
      s["tangents_checked"] = o.counts.tangents_checked;
      s["tangents_off"] = o.counts.tangents_off;
    }
    s["wall_s"] = wall;
    s["cpu_s"] = cpu;
    s["seed"] = options_.seed;
    if (!result_.curve.rows.empty()) add_figures(s);
    s["laboratory"] = study::laboratory_json(result_.figures);
    s["input"] = json_of(input);
    return s;
  }

  void add_figures(Json& s) const {
    const auto& last = result_.curve.rows.back();
    double residual = 0.0, scale = 0.0;
    for (const auto& row : result_.curve.rows) {
      residual = std::max(residual, row.residual);
      scale = std::max({scale, std::abs(row.work), std::abs(row.stored)});
    }
    s["control_residual"] = residual;
    Json energy;
    energy["work_J_per_m3"] = finite_or_null(last.work);
    energy["stored_J_per_m3"] = finite_or_null(last.stored);
    energy["dissipated_J_per_m3"] = finite_or_null(last.dissipated);
    energy["hypoelastic_J_per_m3"] = finite_or_null(last.hypoelastic);
    const double error = last.work - last.stored - last.dissipated - last.hypoelastic;
    energy["unaccounted_J_per_m3"] = finite_or_null(error);
    energy["unaccounted_relative"] = finite_or_null(scale > 0.0 ? error / scale : 0.0);
    s["energy"] = energy;
    Json end;
    for (const point::Quantity q : point::columns_of(*result_.law, file_.test))
      end[std::string(point::column_name(q))] = finite_or_null(column(q).back());
    s["end"] = end;
    const auto q = column(point::Quantity::q);
    s["q_max_Pa"] = finite_or_null(*std::max_element(q.begin(), q.end()));
  }

  /// Whether there is one. A picture that cannot be drawn is a warning, not a failure: the figures
  /// are in curve.csv.
  bool draw(const io::ResultFolder& folder) const {
    if (options_.no_plot || result_.curve.rows.empty()) return false;
    try {
      const std::string changes = fmt::format("{}", fmt::join(options_.sets, ", "));
      report::point_picture(file_, result_.theta, result_.curve, changes)
          .render_svg(folder.file("curve.svg"));
      return true;
    } catch (const report::PlotError& error) {
      fmt::print(stderr, "warning: no curve.svg: {}\n", error.what());
    } catch (const std::logic_error& error) {
      fmt::print(stderr, "warning: no curve.svg: {}\n", error.what());
    }
    return false;
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

io::ExitCode run_test(const std::string& path, const CommonOptions& options) {
  input::InputFile input = input::open_test(path, options.sets);
  input::require_kind(input, input::FileKind::point_test, "point");
  const std::optional<input::ParameterSets> sweep = input::read_sweep(input);
  if (sweep) {
    input.throw_if_bad();
    return run_point_sweep(path, input, *sweep, options);
  }
  for (const auto& [given, option] :
       {std::pair{options.resume, "--resume"}, {options.threads > 0, "--threads"}})
    if (given)
      throw input::BadInput(
          {fmt::format("{} goes with a [sweep], and {} has none", option, input.name())});
  return PointRun(path, std::move(input), options).run();
}

}  // namespace

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
  return {verb.app(), options, [options, file] { return run_test(*file, *options); }};
}

}  // namespace repose::app
