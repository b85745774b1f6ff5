#include "study/point/test_record.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "input/read_law.hpp"
#include "models/instruction_set.hpp"
#include "repose_version.hpp"
#include "study/point/laboratory_record.hpp"

namespace repose::study {
namespace {

using io::Json;

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

void add_figures(const input::PointTestFile& file, const TestResult& result, Json& s) {
  const auto column = [&](point::Quantity q) {
    return columns_of(file, result, std::array{q}).front();
  };
  const auto& last = result.curve.rows.back();
  double residual = 0.0, scale = 0.0;
  for (const auto& row : result.curve.rows) {
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
  for (const point::Quantity q : point::columns_of(*result.law, file.test))
    end[std::string(point::column_name(q))] = finite_or_null(column(q).back());
  s["end"] = end;
  const auto q = column(point::Quantity::q);
  s["q_max_Pa"] = finite_or_null(*std::max_element(q.begin(), q.end()));
}

}  // namespace

toml::table resolved_test(const input::InputFile& input, const input::PointTestFile& file) {
  toml::table table = input.root();
  const bool own_options = !input::own_option_lines(file.law).empty();  // they stand in law_lines()
  if (own_options)
    table.insert_or_assign("law", toml::table(toml::parse(input::law_lines(file.law))));
  if (!table.contains("law")) table.insert("law", toml::table{});
  toml::table& law = *table["law"].as_table();
  for (const auto& [key, text] : file.law.options) {
    if (own_options) break;
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

Json test_summary(const input::PointTestFile& file, const TestResult& result,
                  const toml::table& input, double cpu_s, std::uint64_t seed) {
  const point::Outcome& o = result.curve.outcome;
  Json s;
  s["repose"] = version_string;
  s["instruction_set"] = instruction_set();
  s["kind"] = "point_test";
  s["name"] = file.name;
  s["status"] = result.failed() ? "failed" : "done";
  s["reason"] = result.reason;
  s["fraction"] = o.fraction;
  s["method"] = point::name_of(point::method_for(*result.law, file.test.settings.method));
  s["tolerance"] = file.test.settings.tolerance;
  s["strain"] = point::name_of(file.test.path.measure);
  s["warnings"] = file.notes;
  s["rows"] = result.curve.rows.size();
  s["steps"] = o.counts.steps;
  s["steps_rejected"] = o.counts.rejected;
  s["rate_evaluations"] = o.counts.rates;
  s["events"] = o.counts.events;
  if (o.counts.tangents_checked > 0) {
    s["tangents_checked"] = o.counts.tangents_checked;
    s["tangents_off"] = o.counts.tangents_off;
  }
  s["wall_s"] = result.wall_s;
  s["cpu_s"] = cpu_s;
  s["seed"] = seed;
  if (!result.curve.rows.empty()) add_figures(file, result, s);
  s["laboratory"] = laboratory_json(result.figures);
  s["input"] = json_of(input);
  return s;
}

}  // namespace repose::study
