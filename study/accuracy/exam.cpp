#include "study/accuracy/exam.hpp"

#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/core.h>

#include "io/json.hpp"

namespace repose::study {
namespace {

using Json = io::Json;

std::string per_cent(double x) {
  return std::isfinite(x) ? fmt::format("{:.3g} %", 100.0 * x) : std::string("–");
}

std::string row_of(const std::string& name, const Marks& marks) {
  return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", name, marks.questions(),
                     marks[Verdict::within], marks[Verdict::beyond], per_cent(marks.share_within()),
                     marks[Verdict::bar_holds], marks[Verdict::bar_broken],
                     marks[Verdict::undecidable]);
}

std::string head(std::string_view of_what) {
  return fmt::format(
      "\n| {} | questions | promised: within 1.5 × target | beyond | share within | cannot "
      "promise: "
      "bar holds | broken | undecidable |\n|---|---|---|---|---|---|---|---|\n",
      of_what);
}

}  // namespace

Reference reference_of_both(const Reference& a, const Reference& b) {
  Reference both = a;
  both.value = 0.5 * (a.value + b.value);
  both.error = std::hypot(0.5 * (a.error + b.error),
                          0.5 * (a.value - b.value).lpNorm<1>() / both.value.lpNorm<1>());
  return both;
}

Verdict verdict_of(const Graded& answer) {
  const double judged_by = answer.promised ? answer.target : answer.bar;
  if (answer.reference_bar > 0.5 * judged_by) return Verdict::undecidable;
  if (answer.promised)
    return answer.error <= 1.5 * answer.target ? Verdict::within : Verdict::beyond;
  return answer.error <= answer.bar ? Verdict::bar_holds : Verdict::bar_broken;
}

void Marks::add(const Graded& answer) {
  ++count[static_cast<std::size_t>(verdict_of(answer))];
  not_promised += answer.promised ? 0 : 1;
}

int Marks::questions() const {
  int sum = 0;
  for (const int n : count) sum += n;
  return sum;
}

double Marks::share_within() const {
  const int decided = (*this)[Verdict::within] + (*this)[Verdict::beyond];
  return decided == 0
             ? std::nan("")
             : static_cast<double>((*this)[Verdict::within]) / static_cast<double>(decided);
}

double Marks::share_not_promised() const {
  return static_cast<double>(not_promised) / static_cast<double>(questions());
}

std::string exam_tables(std::span<const Graded> answers) {
  Marks all, shipped_at_5;
  std::map<std::string, Marks> by_question, by_basis, by_target;
  std::map<std::string, Marks> by_scene;
  for (const Graded& answer : answers) {
    all.add(answer);
    by_question[fmt::format("{}, {:g} %", answer.quantity, 100.0 * answer.target)].add(answer);
    by_target[fmt::format("{:g} %", 100.0 * answer.target)].add(answer);
    by_basis[answer.basis].add(answer);
    by_scene[answer.scene].add(answer);
    if (answer.shipped && std::abs(answer.target - 0.05) < 1e-9) shipped_at_5.add(answer);
  }
  std::string text = head("of what");
  text += row_of(fmt::format("all, {} scenes", by_scene.size()), all);
  text += row_of("shipped scenes at 5 %", shipped_at_5);
  for (const auto* rows : {&by_target, &by_question})
    for (const auto& [name, marks] : *rows) text += row_of(name, marks);
  for (const auto& [name, marks] : by_basis) text += row_of("basis: " + name, marks);
  text += fmt::format(
      "\nNot promised: {} of all questions, {} of the shipped scenes' at 5 %.\n",
      per_cent(all.share_not_promised()),
      shipped_at_5.questions() == 0 ? "–" : per_cent(shipped_at_5.share_not_promised()));
  text += head("scene");
  for (const auto& [name, marks] : by_scene) text += row_of(name, marks);
  text +=
      "\n| not as promised, or not to be decided | asked for | target | said | bar | off by | "
      "reference ± | finest cells | CPU s |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const Graded& answer : answers) {
    const Verdict verdict = verdict_of(answer);
    if (verdict == Verdict::within || verdict == Verdict::bar_holds) continue;
    constexpr std::array<std::string_view, verdict_count> words{"", "beyond", "", "bar broken",
                                                                "undecidable"};
    text += fmt::format("| {}: {} | {} | {:g} % | {}, {} | {} | {} | {} | {:.3g} mm | {:.2g} |\n",
                        answer.scene, words[static_cast<std::size_t>(verdict)], answer.quantity,
                        100.0 * answer.target, answer.promised ? "met" : "cannot promise",
                        answer.basis, per_cent(answer.bar), per_cent(answer.error),
                        per_cent(answer.reference_bar), 1e3 * answer.finest_h, answer.cpu_s);
  }
  return text;
}

std::string line_of(const Graded& answer) {
  const auto finite_or_null = [](double x) { return std::isfinite(x) ? Json(x) : Json(); };
  return Json{{"scene", answer.scene},
              {"shipped", answer.shipped},
              {"quantity", answer.quantity},
              {"target", answer.target},
              {"promised", answer.promised},
              {"basis", answer.basis},
              {"bar", finite_or_null(answer.bar)},
              {"error", answer.error},
              {"reference_bar", finite_or_null(answer.reference_bar)},
              {"cpu_s", answer.cpu_s},
              {"finest_h_m", answer.finest_h}}
      .dump();
}

Graded graded_of(std::string_view line) {
  try {
    const Json j = Json::parse(line);
    Graded a;
    a.scene = j.at("scene").get<std::string>();
    a.shipped = j.at("shipped").get<bool>();
    a.quantity = j.at("quantity").get<std::string>();
    a.target = j.at("target").get<double>();
    a.promised = j.at("promised").get<bool>();
    a.basis = j.at("basis").get<std::string>();
    const auto finite_or_infinite = [&](const char* key) {
      return j.at(key).is_null() ? HUGE_VAL : j.at(key).get<double>();
    };
    a.bar = finite_or_infinite("bar");
    a.error = j.at("error").get<double>();
    a.reference_bar = finite_or_infinite("reference_bar");
    a.cpu_s = j.at("cpu_s").get<double>();
    a.finest_h = j.at("finest_h_m").get<double>();
    return a;
  } catch (const Json::Error& error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace repose::study
