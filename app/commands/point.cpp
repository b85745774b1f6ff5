#include <algorithm>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "app/commands/command.hpp"
#include "input/file_kind.hpp"
#include "input/shipped_input.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "report/picture/point_picture.hpp"
#include "report/plot/gnuplot.hpp"
#include "repose_version.hpp"
#include "study/run/run_record.hpp"

namespace repose::app {
namespace {

using Json = io::Json;

/// The input with what the command line changed and the defaults that numbers depend on.
toml::table resolved(const input::InputFile& input, const input::PointTestFile& file) {
  toml::table table = input.root();
  if (!table.contains("law")) table.insert("law", toml::table{});
  toml::table& law = *table["law"].as_table();
  for (const auto& [key, text] : file.law.options) {
    if (text == "true" || text == "false")
      law.insert_or_assign(key, text == "true");
    else
      law.insert_or_assign(key, text);
  }
  for (const auto& [key, x] : file.law.values) law.insert_or_assign(key, x);
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
  PointRun(const std::string& path, const CommonOptions& options)
      : options_(options),
        input_(input::open_test(path, options.sets)) {
    input::require_kind(input_, input::FileKind::point_test, "point");
    file_ = input::read_point_test(input_);
    law_ = &find_law(file_.law);
    theta_ = checked_parameters(file_.law);
    origin_ = "From " + path;
    for (const std::string& set : options.sets) origin_ += " --set " + set;
    std::replace_if(
        origin_.begin(), origin_.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  }

  io::ExitCode run() {
    const io::ResultFolder folder(options_.output.empty()
                                      ? io::ResultFolder::default_path(file_.name)
                                      : std::filesystem::path(options_.output));
    folder.remove_old_outputs();
    const toml::table input = resolved(input_, file_);
    write(folder, "input.toml", toml_text(input, origin_));
    const study::Usage before = study::usage();
    const point::Outcome outcome = point::simulate(*law_, theta_, file_.test, curve_);
    const study::Usage after = study::usage();
    reason_ = point::explain(*law_, theta_, file_.test, curve_);
    write(folder, "curve.csv", csv());
    const Json report = summary(input, after.wall_s - before.wall_s, after.cpu_s - before.cpu_s);
    write(folder, "summary.json", report.dump(2) + "\n");
    const bool drawn = draw(folder);
    if (!options_.quiet)
      for (const std::string& note : file_.notes) fmt::print(stderr, "warning: {}\n", note);
    tell(folder, report, drawn);
    return point::is_failure(outcome.status) ? io::ExitCode::numerical_failure : io::ExitCode::done;
  }

 private:
  /// Not to the disk at once: the test is driven again in less time than that takes.
  static void write(const io::ResultFolder& folder, std::string_view name,
                    const std::string& content) {
    folder.write_file(name, content, io::Outlives::kill);
  }

  std::vector<double> column(point::Quantity quantity) const {
    std::vector<double> values;
    point::read_column(*law_, theta_, file_.test, curve_, quantity, values);
    return values;
  }

  std::string csv() const {
    std::string text;
    std::vector<std::vector<double>> columns;
    for (const point::Quantity q : point::columns_of(*law_, file_.test)) {
      text += (text.empty() ? "" : ",") + std::string(point::column_name(q));
      columns.push_back(column(q));
    }
    text += "\n";
    for (std::size_t row = 0; row < curve_.rows.size(); ++row)
      for (std::size_t i = 0; i < columns.size(); ++i)
        text += fmt::format("{}{}", columns[i][row] + 0.0, i + 1 < columns.size() ? ',' : '\n');
    return text;
  }

  Json summary(const toml::table& input, double wall, double cpu) const {
    const point::Outcome& o = curve_.outcome;
    Json s;
    s["repose"] = version_string;
    s["kind"] = "point_test";
    s["name"] = file_.name;
    s["status"] = point::is_failure(o.status) ? "failed" : "done";
    s["reason"] = reason_;
    s["fraction"] = o.fraction;
    s["method"] = point::name_of(point::method_for(*law_, file_.test.settings.method));
    s["tolerance"] = file_.test.settings.tolerance;
    s["strain"] = point::name_of(file_.test.path.measure);
    s["warnings"] = file_.notes;
    s["rows"] = curve_.rows.size();
    s["steps"] = o.counts.steps;
    s["steps_rejected"] = o.counts.rejected;
    s["rate_evaluations"] = o.counts.rates;
    s["events"] = o.counts.events;
    s["wall_s"] = wall;
    s["cpu_s"] = cpu;
    s["seed"] = options_.seed;
    if (!curve_.rows.empty()) add_figures(s);
    s["input"] = json_of(input);
    return s;
  }

  void add_figures(Json& s) const {
    const auto& last = curve_.rows.back();
    double residual = 0.0, scale = 0.0;
    for (const auto& row : curve_.rows) {
      residual = std::max(residual, row.residual);
      scale = std::max({scale, std::abs(row.work), std::abs(row.stored)});
    }
    s["control_residual"] = residual;
    Json energy;
    energy["work_J_per_m3"] = finite_or_null(last.work);
    energy["stored_J_per_m3"] = finite_or_null(last.stored);
    energy["dissipated_J_per_m3"] = finite_or_null(last.dissipated);
    const double error = last.work - last.stored - last.dissipated;
    energy["unaccounted_J_per_m3"] = finite_or_null(error);
    energy["unaccounted_relative"] = finite_or_null(scale > 0.0 ? error / scale : 0.0);
    s["energy"] = energy;
    Json end;
    for (const point::Quantity q : point::columns_of(*law_, file_.test))
      end[std::string(point::column_name(q))] = finite_or_null(column(q).back());
    s["end"] = end;
    const auto q = column(point::Quantity::q);
    s["q_max_Pa"] = finite_or_null(*std::max_element(q.begin(), q.end()));
  }

  /// Whether there is one. A picture that cannot be drawn is a warning, not a failure: the figures
  /// are in curve.csv.
  bool draw(const io::ResultFolder& folder) const {
    if (options_.no_plot || curve_.rows.empty()) return false;
    try {
      report::point_picture(file_, theta_, curve_).render_svg(folder.file("curve.svg"));
      return true;
    } catch (const report::PlotError& error) {
      fmt::print(stderr, "warning: no curve.svg: {}\n", error.what());
    } catch (const std::logic_error& error) {
      fmt::print(stderr, "warning: no curve.svg: {}\n", error.what());
    }
    return false;
  }

  void tell(const io::ResultFolder& folder, const Json& report, bool drawn) const {
    const bool failed = point::is_failure(curve_.outcome.status);
    if (failed) fmt::print(stderr, "{}: {}\n", input_.name(), reason_);
    if (options_.json) {
      Json line{{"event", "done"}, {"folder", folder.path().string()}};
      for (const char* key : {"status", "reason", "rows", "wall_s"}) line[key] = report[key];
      fmt::print("{}\n", line.dump());
    } else if (!options_.quiet) {
      fmt::print("{}: {} rows by {} in {:.3g} ms{}; {}\n", folder.path().string(),
                 curve_.rows.size(), report["method"].get<std::string>(),
                 1e3 * report["wall_s"].get<double>(), failed ? "" : ", " + reason_,
                 drawn ? "curve.csv, curve.svg, summary.json" : "curve.csv, summary.json");
    }
  }

  CommonOptions options_;
  input::InputFile input_;
  input::PointTestFile file_;
  const LawInfo* law_ = nullptr;
  std::vector<double> theta_;
  std::string origin_;
  point::Curve curve_;
  std::string reason_;
};

}  // namespace

Command add_point(CLI::App& root) {
  Verb verb(root, "point", "Drive one material point along a path");
  verb.footer(
      "Examples:\n"
      "  repose point weald_clay_undrained\n"
      "  repose point weald_clay_undrained --set initial.ocr=8 -o results/oc\n"
      "  repose point my_test.toml --set law=results/my_fit/fitted.toml\n"
      "Writes curve.csv, curve.svg, summary.json and input.toml. A path that cannot be finished\n"
      "leaves the part done and returns 3.");
  const auto options = std::make_shared<CommonOptions>();
  const auto file = std::make_shared<std::string>();
  verb.required("TEST.toml", *file,
                fmt::format("A file, or one of {}", fmt::join(input::shipped_tests(), ", ")), "");
  verb.option("-o,--output", options->output, "Result folder (default: results/NAME)", "DIR");
  add_set(verb, *options);
  add_no_plot(verb, *options);
  add_quiet(verb, *options);
  return {verb.app(), options, [options, file] { return PointRun(*file, *options).run(); }};
}

}  // namespace repose::app
