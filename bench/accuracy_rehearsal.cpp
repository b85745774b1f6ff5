/// \file
/// `repose run --accuracy` rehearsed on scenes that have been charted (scripts/accuracy constants):
/// each is predicted with the constants of the others, and its runs are read, not made.
///   bench_accuracy_rehearsal results/accuracy
/// Prints the rows of study/accuracy/rehearsed_rows.inc, and, per quantity and target: of how many answers, how many are within 1.5 times the target, and how
/// many cost at most 3 times the cheapest single run that meets it together with all finer ones.

#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include <fmt/core.h>

#include "study/accuracy/accuracy_table.hpp"
#include "study/accuracy/decision.hpp"
#include "study/accuracy/errors.hpp"

namespace repose::study {
namespace {

namespace fs = std::filesystem;
using Eigen::VectorXd;
using study::Convergence;
using study::ErrorModel;
using study::Level;
using study::Outcome;
using study::ShownErrors;

constexpr std::array targets{0.02, 0.03, 0.04, 0.05, 0.06, 0.08};

struct Chart {
  std::string name;
  input::SceneFile scene;
  std::vector<SweepRun> runs;
  std::vector<SweepFamily> families;
  SweepReference reference;
  double bin = 0.0;

  const std::string& law() const { return scene.scene.bodies.front().law.name; }
};

Chart read(const fs::path& folder) {
  input::InputFile file = input::InputFile::read(folder / "input.toml");
  const input::ChartTable table = input::read_chart(file);
  Chart chart{folder.filename(), input::read_scene(file), {}, {}, {}, {}};
  chart.runs = runs_of(chart.scene, table.sweep);
  for (SweepRun& run : chart.runs) carry_out(run, folder / "runs", 1, false);
  return chart;
}

/// What a scene's runs of one kernel are: by cell size, coarse to fine.
struct Made {
  std::vector<double> sizes, point_steps;
  std::vector<VectorXd> values;
  std::vector<double> errors;
  std::optional<VectorXd> start;
};

Made made_with(const Chart& chart, const Candidate& candidate, Quantity q) {
  Made made;
  const VectorXd& limit = chart.reference.values[static_cast<std::size_t>(q)]->value;
  for (const SweepFamily& family : chart.families) {
    if (family.scene().kernel != candidate.kernel) continue;
    for (const SweepRun* run : family.runs) {
      made.sizes.push_back(run->scene().h);
      made.point_steps.push_back(run->point_steps() * run->scene().courant / candidate.courant);
      made.values.push_back(shares_of(*run, q, chart.bin));
      made.errors.push_back(study::relative_distance(made.values.back(), limit));
    }
    made.start = start_of(*family.runs.front(), q, chart.bin);
  }
  return made;
}

/// The least cost of a run that meets the target with every finer one of its kernel; infinite where
/// there is none.
double cheapest_alone(const Made& made, double target) {
  double cheapest = HUGE_VAL;
  for (std::size_t k = made.sizes.size(); k-- > 0 && made.errors[k] <= target;)
    cheapest = std::min(cheapest, made.point_steps[k]);
  return cheapest;
}

/// A candidate's model with what the other scenes show.
ErrorModel model_without(const Chart& own, const std::vector<Chart>& charts,
                         const Candidate& candidate, Quantity q) {
  std::vector<ShownErrors> of_law, of_all;
  for (const Chart& chart : charts) {
    if (&chart == &own || !chart.reference.values[static_cast<std::size_t>(q)]) continue;
    for (const SweepFamily& family : chart.families) {
      if (family.scene().kernel != candidate.kernel) continue;
      of_all.push_back(shown_errors(family, q, chart.reference, chart.bin));
      if (chart.law() == own.law()) of_law.push_back(of_all.back());
    }
  }
  ErrorModel model = study::pooled_model(of_law, candidate.model);
  model.irregularity = study::pooled_model(of_all, candidate.model).irregularity;
  model.scatter = candidate.model.scatter;
  return model;
}

struct Rehearsal {
  bool met;  ///< by the model, its own runs not contradicting
  double error, cost, cheapest;
};

std::optional<Rehearsal> answer_for(const Chart& chart, const std::vector<Chart>& charts, Quantity q,
                                 double target) {
  const auto& reference = chart.reference.values[static_cast<std::size_t>(q)];
  // what the reference cannot judge
  if (!reference || reference->error > 0.5 * target) return {};
  const double length = length_of(chart.scene.scene);
  std::optional<ErrorModel> model;
  Made made;
  std::pair<bool, double> best_rank;
  double cheapest = HUGE_VAL;
  for (const Candidate& candidate : candidates_for(chart.scene.scene, q)) {
    const ErrorModel its_model = model_without(chart, charts, candidate, q);
    Made its = made_with(chart, candidate, q);
    if (its.sizes.size() < 2) continue;  // not charted with this kernel
    const study::Plan plan = study::cheapest_plan(Convergence(its_model, length), its.sizes,
                                                  its.point_steps, target, HUGE_VAL);
    const bool meets = plan.error <= target;
    const std::pair rank(!meets, meets ? plan.cost : plan.error);
    cheapest = std::min(cheapest, cheapest_alone(its, target));
    if (model && rank >= best_rank) continue;
    model = its_model;
    made = std::move(its);
    best_rank = rank;
  }
  Convergence so_far(*model, length);
  if (made.start) so_far.starts_from(*made.start);
  double cost = 0.0;
  const Outcome outcome = study::run_to_target(
      so_far, {target, HUGE_VAL, {}}, made.sizes, made.point_steps,
      [&](const Level& next) -> std::optional<VectorXd> {
        if (next.runs > 0) return {};  // every size has been run once
        const auto k = static_cast<std::size_t>(
            std::find(made.sizes.begin(), made.sizes.end(), next.h) - made.sizes.begin());
        cost += made.point_steps[k];
        return made.values[k];
      });
  if (outcome == Outcome::stopped) return {};
  const study::Answer given = answer_of(so_far, {target, HUGE_VAL, {}});
  const double error = study::relative_distance(given.estimate.value, reference->value);
  return Rehearsal{outcome == Outcome::met && given.basis == Basis::measured, error, cost, cheapest};
}

struct Tally {
  int answers = 0, close = 0, cheap = 0, out_of_reach = 0;
  void count(const Rehearsal& answer, double target) {
    if (!answer.met) {
      ++out_of_reach;
      return;
    }
    ++answers;
    close += answer.error <= 1.5 * target;
    cheap += answer.cost <= 3.0 * answer.cheapest;
  }
  std::string row(const std::string& name) const {
    const auto share = [&](int n) { return fmt::format("{:.0f} %", 100.0 * n / answers); };
    return fmt::format("| {} | {} | {} | {} | {} |\n", name, answers, share(close), share(cheap),
                       out_of_reach);
  }
};

int rehearse(const fs::path& results) {
  std::vector<Chart> charts;
  std::set<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(results)) {
    const std::string name = entry.path().filename();
    if (name.starts_with("train_") && !name.ends_with("_scatter")) folders.insert(entry.path());
  }
  for (const fs::path& folder : folders) charts.push_back(read(folder));
  for (Chart& chart : charts) {  // they point into the runs, which no longer move
    chart.families = families_of(chart.runs);
    chart.bin = common_bin(chart.runs);
    const auto reference = reference_of(chart.runs, chart.scene.scene);
    if (!reference) {
      fmt::print(stderr, "{}: too few finished runs\n", chart.name);
      return 1;
    }
    chart.reference = *reference;
  }
  std::map<std::tuple<std::string, Quantity, double>, Tally> by_row;
  std::map<Quantity, Tally> by_quantity;
  std::map<double, Tally> by_target;
  for (const Chart& chart : charts)
    for (std::size_t k = 0; k < advised_names.size(); ++k)
      for (const double target : targets) {
        const auto q = static_cast<Quantity>(k);
        const auto answer = answer_for(chart, charts, q, target);
        if (!answer) continue;
        by_quantity[q].count(*answer, target);
        by_target[target].count(*answer, target);
        by_row[{chart.law(), q, target}].count(*answer, target);
        if (answer->met && (answer->error > 1.5 * target || answer->cost > 3.0 * answer->cheapest))
          fmt::print(stderr, "{} {} {:g}: error {:.3f}, cost {:.2g} of the cheapest\n", chart.name,
                     name_of(q), target, answer->error, answer->cost / answer->cheapest);
      }
  fmt::print(
      "{} scenes\n\n| | answers | within 1.5 × target | at most 3 × cheapest | out of reach |\n"
      "|---|---|---|---|---|\n",
      charts.size());
  for (const auto& [q, tally] : by_quantity) fmt::print("{}", tally.row(std::string(name_of(q))));
  for (const auto& [target, tally] : by_target)
    fmt::print("{}", tally.row(fmt::format("{:g} %", 100.0 * target)));
  fmt::print("\n");
  for (const auto& [key, tally] : by_row) {
    const auto& [law, q, target] = key;
    if (tally.answers == 0) continue;
    const mpm::Scene& of_law =
        std::find_if(charts.begin(), charts.end(), [&](const Chart& c) { return c.law() == law; })
            ->scene.scene;
    fmt::print("Row{{\"{}\", \"{}\", Quantity::{}, {:g}, {}, {}}},\n", law,
               find_law(of_law.bodies.front().law).option, name_of(q), target, tally.answers,
               tally.close);
  }
  return 0;
}

}  // namespace
}  // namespace repose::study

int main(int count, char** words) {
  if (count != 2) {
    fmt::print(stderr, "bench_accuracy_rehearsal RESULTS\n");
    return 2;
  }
  return repose::study::rehearse(words[1]);
}
