/// \file
/// An exam for `repose run --accuracy`, one scene at a time (scripts/accuracy exam):
///   bench_accuracy_exam answer FOLDER NAME SCENE SIZES BUDGET [KEY=VALUE...]
/// asks for all five quantities to 2, 3 and 5 %, each with BUDGET CPU seconds, and writes
/// FOLDER/NAME/answers.jsonl. The references are extrapolated from cells of SIZES (three,
/// "0.0083,0.0042,0.0021" [m]) with both kernels and two Courant numbers, the finest with one; they
/// use other steps than the answers, so they share no run with them. A scene is
/// shipped that has a shipped one's name and no KEY=VALUE. Runs in FOLDER/NAME/runs are not
/// repeated.
///   bench_accuracy_exam tables FOLDER
/// prints the tables of docs/accuracy.md from all answers in FOLDER.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include <fmt/core.h>

#include "input/shipped_input.hpp"
#include "study/accuracy/accurate_run.hpp"
#include "study/accuracy/errors.hpp"
#include "study/accuracy/exam.hpp"
#include "study/run/finished_result.hpp"

namespace repose::study {
namespace {

namespace fs = std::filesystem;

constexpr std::array targets{0.05, 0.03, 0.02};
constexpr const char* answers_file = "answers.jsonl";

struct Paper {
  std::string name;
  fs::path folder;
  input::SceneFile file;
  std::vector<double> sizes;
  double budget = 0.0;
  bool shipped = false;
};

using References = std::array<std::optional<Reference>, advised_names.size()>;

/// Runs of one kernel at the reference's sizes.
std::vector<SweepRun> reference_runs(const Paper& paper, const mpm::Scene& scene,
                                     const Candidate& candidate) {
  // the answers take the longest step and up to 7 that are 4 % shorter each
  constexpr std::array steps_shorter{8, 10};
  std::vector<SweepRun> runs;
  for (const double h : paper.sizes)
    for (const int k : steps_shorter) {
      if (h == paper.sizes.back() && k != steps_shorter.front()) continue;
      runs.push_back(run_of(paper.file, scene_with(scene, candidate, h, k)));
      carry_out(runs.back(), paper.folder / "runs", 1, true);
      if (!runs.back().done())
        throw std::runtime_error(
            fmt::format("{}: {}", runs.back().scene().name, runs.back().summary.reason));
    }
  return runs;
}

References references_for(const Paper& paper, const AccurateRun& work) {
  References both;
  for (const Candidate& candidate : candidates_for(work.scene(), Quantity::kinetic)) {
    const std::vector<SweepRun> runs = reference_runs(paper, work.scene(), candidate);
    const std::vector<SweepFamily> families = families_of(runs);
    for (std::size_t k = 0; k < advised_names.size(); ++k) {
      const auto q = static_cast<Quantity>(k);
      const Reference its = extrapolated_reference(families.front().levels(q, work.bin()));
      both[k] = both[k] ? reference_of_both(*both[k], its) : its;
    }
  }
  return both;
}

Graded graded(const Paper& paper, const AccurateRun& work, const Reference& reference) {
  const AccuracyGoal& goal = work.goal();
  Graded graded;
  graded.scene = paper.name;
  graded.shipped = paper.shipped;
  graded.quantity = name_of(goal.quantity);
  graded.target = goal.target;
  graded.reference_bar = reference.error;
  graded.cpu_s = work.cpu_s();
  if (work.convergence().levels().empty()) {  // no run came to its end
    graded.bar = HUGE_VAL;
    graded.error = 1.0;
    graded.basis = name_of(Basis::own_runs);
    return graded;
  }
  const Answer answer = work.answer();
  graded.promised = answer.met;
  graded.basis = name_of(answer.basis);
  graded.bar = answer.estimate.error;
  graded.error = relative_distance(answer.estimate.value, reference.value);
  graded.finest_h = work.convergence().levels().back().h;
  return graded;
}

int answer(const Paper& paper) {
  fs::create_directories(paper.folder);
  std::string lines;
  std::optional<References> references;
  for (std::size_t k = 0; k < advised_names.size(); ++k)
    for (const double target : targets) {
      AccuracyGoal goal;
      goal.file = paper.file;
      goal.quantity = static_cast<Quantity>(k);
      goal.target = target;
      goal.budget = paper.budget;
      goal.runs = paper.folder / "runs";
      goal.threads = 1;
      AccurateRun work(goal);
      if (work.run([](const SweepRun&) {}) == AccurateRun::End::interrupted) return 1;
      if (!references) references = references_for(paper, work);
      const Graded its = graded(paper, work, *(*references)[k]);
      lines += line_of(its) + "\n";
      fmt::print(stderr, "{} {} {:g} %: {}, bar {:.2g} %, off by {:.2g} %, {:.2g} s\n", its.scene,
                 its.quantity, 100.0 * target, its.promised ? "met" : "cannot promise",
                 100.0 * its.bar, 100.0 * its.error, its.cpu_s);
    }
  std::ofstream(paper.folder / answers_file) << lines;
  return 0;
}

int tables(const fs::path& folder) {
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (fs::exists(entry.path() / answers_file)) files.insert(entry.path() / answers_file);
  std::vector<Graded> answers;
  for (const fs::path& file : files) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) answers.push_back(graded_of(line));
  }
  fmt::print("{}", exam_tables(answers));
  return 0;
}

std::vector<double> numbers_of(std::string_view list) {
  std::vector<double> numbers;
  while (!list.empty()) {
    const std::string_view one = list.substr(0, list.find(','));
    numbers.push_back(std::stod(std::string(one)));
    list.remove_prefix(std::min(list.size(), one.size() + 1));
  }
  return numbers;
}

int run(const std::vector<std::string>& words) {
  if (words.size() == 2 && words[0] == "tables") return tables(words[1]);
  if (words.size() < 6 || words[0] != "answer") {
    fmt::print(stderr,
               "bench_accuracy_exam answer FOLDER NAME SCENE SIZES BUDGET [KEY=VALUE...]\n"
               "bench_accuracy_exam tables FOLDER\n");
    return 2;
  }
  Paper paper;
  paper.name = words[2];
  paper.folder = fs::path(words[1]) / paper.name;
  paper.sizes = numbers_of(words[4]);
  paper.budget = std::stod(words[5]);
  const std::vector<std::string> sets(words.begin() + 6, words.end());
  const auto names = input::shipped_scenes();
  paper.shipped = sets.empty() && std::find(names.begin(), names.end(), words[3]) != names.end();
  input::InputFile input = input::open_scene(words[3], sets);
  paper.file = input::read_scene(input);
  return answer(paper);
}

}  // namespace
}  // namespace repose::study

int main(int count, char** words) {
  try {
    return repose::study::run({words + 1, words + count});
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
