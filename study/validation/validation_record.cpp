#include "study/validation/validation_record.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "input/toml_text.hpp"
#include "io/number_text.hpp"
#include "models/instruction_set.hpp"
#include "repose_version.hpp"

namespace repose::study {
namespace {

/// A number as a cell: blank where there is none.
std::string result_cell(double x) { return std::isfinite(x) ? fmt::format("{}", x) : ""; }

/// A curve has no measured value: the table is what was measured.
std::string result_row(const CaseResult& result, std::size_t figure, std::size_t column) {
  const input::BenchmarkFigure& asked = result.benchmark.figures[figure];
  const LawResult& law = result.laws[column];
  const FigureResult& found = law.figures[figure];
  std::string row =
      fmt::format("{},{},{},{},{}", io::csv_cell(asked.name), input::benchmark_columns[column],
                  io::csv_cell(asked.unit), result_cell(found.estimated.value),
                  result_cell(found.estimated.error));
  const std::size_t sizes = result.sizes().size();
  for (std::size_t k = 0; k < sizes; ++k)
    row += "," + (k < found.values.size() ? result_cell(found.values[k]) : "");
  return row + fmt::format(",{},{},{},{},{},{}\n", result_cell(asked.measured), asked.band[0],
                           asked.band[1], name_of(found.verdict), io::csv_cell(found.reason),
                           law.ran() ? result_cell(law.cpu_s) : "");
}

io::Json case_json(const CaseResult& result) {
  io::Json laws = io::Json::object();
  for (std::size_t column = 0; column < result.laws.size(); ++column) {
    io::Json figures = io::Json::object();
    for (std::size_t k = 0; k < result.benchmark.figures.size(); ++k) {
      const FigureResult& found = result.laws[column].figures[k];
      io::Json figure{{"verdict", name_of(found.verdict)}};
      if (std::isfinite(found.estimated.value)) {
        figure["value"] = found.estimated.value;
        figure["error_bar"] = found.estimated.error;
      }
      if (!found.reason.empty()) figure["reason"] = found.reason;
      figures[result.benchmark.figures[k].name] = figure;
    }
    laws[input::benchmark_columns[column]] = figures;
  }
  io::Json json{{"name", result.benchmark.name}, {"title", result.benchmark.title}};
  for (const Verdict verdict :
       {Verdict::inside, Verdict::outside, Verdict::undecided, Verdict::failed})
    json[name_of(verdict)] = result.count(verdict);
  json["cpu_s"] = result.cpu_s();
  json["laws"] = laws;
  return json;
}

}  // namespace

std::string result_csv(const CaseResult& result) {
  std::string text = "figure,column,unit,value,error_bar";
  for (const std::string& size : result.sizes()) text += ",value_" + size;
  text += ",measured,band_low,band_high,verdict,reason,cpu_s\n";
  for (std::size_t figure = 0; figure < result.benchmark.figures.size(); ++figure)
    for (std::size_t column = 0; column < result.laws.size(); ++column)
      text += result_row(result, figure, column);
  return text;
}

io::Json validation_json(std::span<const CaseResult> cases, const std::string& status,
                         const ValidationOptions& options, const std::vector<std::string>& sets) {
  io::Json list = io::Json::array();
  double cpu_s = 0.0;
  for (const CaseResult& result : cases) {
    list.push_back(case_json(result));
    cpu_s += result.cpu_s();
  }
  return {{"repose", version_string}, {"instruction_set", std::string(instruction_set())},
          {"kind", "validation"},     {"status", status},
          {"coarse", options.coarse}, {"set", sets},
          {"cpu_s", cpu_s},           {"cases", list}};
}

std::string validation_input(std::span<const CaseResult> cases, const ValidationOptions& options,
                             const std::vector<std::string>& sets) {
  std::vector<std::string> names, laws, quoted;
  for (const CaseResult& result : cases) names.push_back(input::toml_string(result.benchmark.name));
  for (const std::size_t column : options.columns)
    laws.push_back(input::toml_string(std::string(input::benchmark_columns[column])));
  for (const std::string& set : sets) quoted.push_back(input::toml_string(set));
  return fmt::format(
      "# What `repose validate` {} was asked for.\n[validate]\ncases = [{}]\nlaws = [{}]\n"
      "set = [{}]\ncoarse = {}\n",
      version_string, fmt::join(names, ", "), fmt::join(laws, ", "), fmt::join(quoted, ", "),
      options.coarse);
}

std::string verdict_words(const LawResult& law) {
  const std::size_t absent = law.count(Verdict::absent), not_run = law.count(Verdict::not_run);
  if (absent > 0) return std::string(name_of(Verdict::absent));
  if (not_run == law.figures.size()) return std::string(name_of(Verdict::not_run));
  std::string text = fmt::format("{} of {} inside", law.count(Verdict::inside), law.figures.size());
  for (const Verdict verdict : {Verdict::undecided, Verdict::failed})
    if (const std::size_t count = law.count(verdict); count > 0)
      text += fmt::format(", {} {}", count, name_of(verdict));
  return text;
}

std::string shared_reason(const LawResult& law) {
  if (law.figures.empty()) return "";
  const std::string& reason = law.figures.front().reason;
  const bool shared =
      std::all_of(law.figures.begin(), law.figures.end(),
                  [&](const FigureResult& figure) { return figure.reason == reason; });
  return shared ? reason : "";
}

}  // namespace repose::study
