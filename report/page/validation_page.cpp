#include "report/page/validation_page.hpp"

#include <fmt/format.h>

#include "study/validation/validation_record.hpp"

namespace repose::report {
namespace {

using input::benchmark_columns;
using study::CaseResult;
using study::FigureResult;
using study::Verdict;

/// A text within a cell: no line break, no bar.
std::string in_cell(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (c == '|')
      out += "\\|";
    else
      out += c == '\n' || c == '\r' ? ' ' : c;
  return out;
}

/// A text of several lines without blank ones around it.
std::string_view without_ends(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \n\r\t");
  const std::size_t to = text.find_last_not_of(" \n\r\t");
  return from == std::string_view::npos ? "" : text.substr(from, to - from + 1);
}

/// "1.24 ± 0.03"
std::string with_bar(const study::Estimated& estimated) {
  if (!std::isfinite(estimated.value)) return "–";
  if (!std::isfinite(estimated.error)) return fmt::format("{:.4g}", estimated.value);
  return fmt::format("{:.4g} ± {:.2g}", estimated.value, estimated.error);
}

/// "0.55 m, 0.53 m, …": the values by size.
std::string by_size(const FigureResult& figure) {
  std::string text;
  for (const double value : figure.values)
    text += fmt::format("{}{:.4g}", text.empty() ? "" : ", ", value);
  return text.empty() ? "–" : text;
}

std::string measured_text(const input::BenchmarkFigure& figure) {
  if (figure.is_curve()) return fmt::format("`{}`", figure.table);
  return fmt::format("{:.4g}", figure.measured);
}

std::string verdict_text(const FigureResult& figure) {
  const std::string name(study::name_of(figure.verdict));
  if (figure.reason.empty()) return name;
  return fmt::format("{} ({})", name, in_cell(figure.reason));
}

/// A row per figure and law that ran.
std::string figures_of(const CaseResult& result) {
  std::string text = fmt::format(
      "| figure | unit | law | value | {} | measured | band | verdict |\n"
      "|---|---|---|---|---|---|---|---|\n",
      result.benchmark.is_scene()
          ? fmt::format("with cells of {:.4g} m", fmt::join(result.benchmark.cells, ", "))
          : "as it is, refined");
  for (std::size_t k = 0; k < result.benchmark.figures.size(); ++k) {
    const input::BenchmarkFigure& figure = result.benchmark.figures[k];
    for (std::size_t column = 0; column < result.laws.size(); ++column) {
      const FigureResult& found = result.laws[column].figures[k];
      if (found.verdict == Verdict::absent || found.verdict == Verdict::not_run) continue;
      text += fmt::format("| {} | {} | {} | {} | {} | {} | {:.4g} … {:.4g} | {} |\n",
                          in_cell(figure.title), in_cell(figure.unit), benchmark_columns[column],
                          with_bar(found.estimated), by_size(found), measured_text(figure),
                          figure.band[0], figure.band[1], verdict_text(found));
    }
  }
  return text;
}

/// Where bands and parameters are from, and why laws are absent.
std::string sources_of(const CaseResult& result) {
  std::string text;
  for (const input::BenchmarkFigure& figure : result.benchmark.figures)
    text += fmt::format("- Band of {}: {}\n", in_cell(figure.title), in_cell(figure.band_from));
  for (std::size_t column = 0; column < result.laws.size(); ++column) {
    const input::BenchmarkLaw* const law = result.benchmark.law_of(column);
    const std::string_view name = benchmark_columns[column];
    if (law != nullptr && !law->parameters.empty())
      text += fmt::format("- Parameters of {}: {}\n", name, in_cell(law->parameters));
    const auto absent = result.benchmark.absent.find(std::string(name));
    if (absent != result.benchmark.absent.end())
      text += fmt::format("- No {}: {}\n", name, in_cell(absent->second));
  }
  return text;
}

std::string case_text(const CaseResult& result, bool picture) {
  const input::Benchmark& benchmark = result.benchmark;
  std::string text = fmt::format(
      "\n## {}\n\nCase `{}`. Source: {}\n\n{}\n\n{}\n{}", benchmark.title, benchmark.name,
      benchmark.source, without_ends(benchmark.about), figures_of(result), sources_of(result));
  text += fmt::format("- All runs of this case: {:.3g} s of CPU.\n", result.cpu_s());
  if (picture)
    text += fmt::format("\n![{}]({}/result.svg)\n", in_cell(benchmark.title), benchmark.name);
  return text;
}

}  // namespace

std::string validation_table(std::span<const CaseResult> cases) {
  std::string text = "| case |";
  std::string rule = "|---|";
  for (const std::string_view column : benchmark_columns) {
    text += fmt::format(" {} |", column);
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (const CaseResult& result : cases) {
    text += fmt::format("| {} |", result.benchmark.name);
    for (const study::LawResult& law : result.laws)
      text += fmt::format(" {} |", study::verdict_words(law));
    text += "\n";
  }
  return text;
}

std::string validation_page(std::span<const CaseResult> cases, const std::string& note,
                            bool pictures) {
  std::string text =
      "# Laws against experiments and exact solutions\n\n"
      "Made by `repose validate`. A figure is inside if its value with its error bar lies in the "
      "band, outside\nif it lies beside it, undecided if the bar reaches across an end of the "
      "band, and failed if there is none.\n"
      "Laws: `mcc` modified Cam-Clay, `cs` critical-state μ(I); `_mn` with the cone of Matsuoka & "
      "Nakai in place of the circle.\n";
  if (!note.empty()) text += "\n" + note + "\n";
  text += "\n" + validation_table(cases);
  for (const CaseResult& result : cases) {
    bool ran = false;
    for (const study::LawResult& law : result.laws) ran = ran || law.ran();
    text += case_text(result, pictures && ran);
  }
  return text;
}

}  // namespace repose::report
