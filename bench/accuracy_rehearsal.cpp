/// \file
/// The training scenes of `repose run --accuracy`: charted, and each predicted with the constants
/// of the others (scripts/accuracy).
///   bench_accuracy_rehearsal chart FOLDER SCENE FINEST REFERENCE SCATTER [KEY=VALUE...]
/// charts a scene into FOLDER: both kernels with the cells that --accuracy chooses from, 50 mm to
/// FINEST [m], and the quadratic one with cells of REFERENCE; SCATTER 1: also three sizes with
/// three steps close to each other, into FOLDER_scatter. Runs that are there are not repeated.
///   bench_accuracy_rehearsal predict FOLDER
/// reads all charts train_* in FOLDER and prints, per quantity and target, of how many answers, how
/// many are within 1.5 times the target, and how many cost at most 3 times the cheapest single run
/// that meets it together with all finer ones; then the rows of study/accuracy/rehearsed_rows.inc,
/// and those of accuracy_rows.inc.

#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include <fmt/core.h>

#include "input/resolved_scene.hpp"
#include "input/shipped_input.hpp"
#include "io/result_folder.hpp"
#include "study/accuracy/accuracy_table.hpp"
#include "study/accuracy/decision.hpp"
#include "study/accuracy/errors.hpp"
#include "study/accuracy/trained_domain.hpp"

namespace repose::study {
namespace {

namespace fs = std::filesystem;
using Eigen::VectorXd;
using study::Convergence;
using study::ErrorModel;
using study::Level;
using study::Outcome;
using study::ShownErrors;

constexpr double coarsest_charted = 0.05;  // [m]
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

/// A candidate's model with what the scenes of a law show, but for one of them (null: all).
ErrorModel model_without(const Chart* own, const std::string& law, const std::vector<Chart>& charts,
                         const Candidate& candidate, Quantity q) {
  std::vector<ShownErrors> of_law, of_all;
  for (const Chart& chart : charts) {
    if (&chart == own || !chart.reference.values[static_cast<std::size_t>(q)]) continue;
    for (const SweepFamily& family : chart.families) {
      if (family.scene().kernel != candidate.kernel) continue;
      of_all.push_back(shown_errors(family, q, chart.reference, chart.bin));
      if (chart.law() == law) of_law.push_back(of_all.back());
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

std::optional<Rehearsal> answer_for(const Chart& chart, const std::vector<Chart>& charts,
                                    Quantity q, double target) {
  const auto& reference = chart.reference.values[static_cast<std::size_t>(q)];
  // what the reference cannot judge
  if (!reference || reference->error > 0.5 * target) return {};
  const double length = length_of(chart.scene.scene);
  std::optional<ErrorModel> model;
  Made made;
  std::pair<bool, double> best_rank;
  double cheapest = HUGE_VAL;
  for (const Candidate& candidate : candidates_for(chart.scene.scene, q)) {
    const ErrorModel its_model = model_without(&chart, chart.law(), charts, candidate, q);
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
  return Rehearsal{outcome == Outcome::met && given.basis == Basis::measured, error, cost,
                   cheapest};
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

/// Makes the runs of a chart and notes what they are.
void carry_out_chart(const input::SceneFile& scene, const input::Sweep& sweep, const fs::path& at) {
  const io::ResultFolder folder(at);
  folder.write_file("input.toml", input::resolved_input(scene, "A chart of --accuracy.") +
                                      input::chart_text(sweep));
  for (SweepRun& run : runs_of(scene, sweep)) carry_out(run, at / "runs", 1, true);
}

int chart(const std::vector<std::string>& words) {
  const fs::path folder = words[1];
  const double finest = std::stod(words[3]), reference = std::stod(words[4]);
  std::vector<std::string> sets(words.begin() + 6, words.end());
  sets.insert(sets.end(), {"step.transfer=\"relaxed\"", "grid.kernel=\"quadratic\""});
  input::InputFile input = input::open_scene(words[2], sets);
  const input::SceneFile scene = input::read_scene(input);
  double courant = HUGE_VAL;  // the quadratic kernel's, which is the shorter step
  for (const Candidate& candidate : candidates_for(scene.scene, Quantity::kinetic))
    courant = std::min(courant, candidate.courant);
  input::Sweep sweep;
  sweep.transfers = {mpm::Transfer::relaxed};
  sweep.kernels = {mpm::Kernel::quadratic, mpm::Kernel::cubic};
  sweep.points_per_cell = {scene.scene.points_per_cell};
  for (const double h : sizes_for(scene.scene))
    if (h <= 1.001 * coarsest_charted && h >= 0.999 * finest) sweep.cells.push_back(h);
  sweep.reference = {reference};
  sweep.courants = {courant};
  carry_out_chart(scene, sweep, folder);
  if (words[5] != "1") return 0;
  sweep.reference.clear();
  sweep.cells = {8.0 * finest, 4.0 * finest, 2.0 * finest};
  sweep.courants = {courant, 0.96 * courant, 0.92 * courant};
  carry_out_chart(scene, sweep, folder.string() + "_scatter");
  return 0;
}

/// The charts of a folder whose names end in _scatter, or the others.
std::vector<Chart> charts_in(const fs::path& results, bool of_scatter) {
  std::vector<Chart> charts;
  std::set<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(results)) {
    const std::string name = entry.path().filename();
    if (name.starts_with("train_") && name.ends_with("_scatter") == of_scatter)
      folders.insert(entry.path());
  }
  for (const fs::path& folder : folders) charts.push_back(read(folder));
  for (Chart& chart : charts) {  // they point into the runs, which no longer move
    chart.families = families_of(chart.runs);
    chart.bin = common_bin(chart.runs);
    const auto reference = reference_of(chart.runs, chart.scene.scene);
    if (!reference) throw std::runtime_error(chart.name + ": too few finished runs");
    chart.reference = *reference;
  }
  return charts;
}

/// The constants of each law, kernel and quantity from all charts; those of a quantity's
/// irregularity from all laws, of which some have few scenes.
void print_constants(const std::vector<Chart>& charts, const std::vector<Chart>& scatters) {
  std::map<std::string, const Chart*> laws;
  for (const Chart& chart : charts) laws.emplace(chart.law(), &chart);
  for (const auto& [law, first] : laws)
    for (std::size_t k = 0; k < advised_names.size(); ++k)
      for (const Candidate& way : candidates_for(first->scene.scene, static_cast<Quantity>(k))) {
        const auto q = static_cast<Quantity>(k);
        Candidate with_scatter = way;
        std::vector<ShownErrors> shown;
        for (const Chart& chart : scatters)
          for (const SweepFamily& family : chart.families)
            if (chart.law() == law && family.scene().kernel == way.kernel)
              shown.push_back(shown_errors(family, q, chart.reference, chart.bin));
        if (!shown.empty()) with_scatter.model.scatter = pooled_model(shown, way.model).scatter;
        const ErrorModel model = model_without(nullptr, law, charts, with_scatter, q);
        fmt::print(
            "Row{{\"{}\", Kernel::{}, Transfer::relaxed, {:g}, Quantity::{}, {:.3g}, {:.3g}, "
            "{:.3g}, {:.3g}}},\n",
            law, mpm::name_of(way.kernel), way.courant, name_of(q), model.bias, model.motion,
            model.irregularity, model.scatter);
      }
}

int rehearse(const fs::path& results) {
  const std::vector<Chart> charts = charts_in(results, false);
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
    const mpm::Scene& of_law = std::find_if(charts.begin(), charts.end(), [&](const Chart& c) {
                                 return c.law() == law;
                               })->scene.scene;
    fmt::print("Row{{\"{}\", \"{}\", Quantity::{}, {:g}, {}, {}}},\n", law,
               find_law(of_law.bodies.front().law).option, name_of(q), target, tally.answers,
               tally.close);
  }
  fmt::print("\n");
  print_constants(charts, charts_in(results, true));
  return 0;
}

}  // namespace
}  // namespace repose::study

int main(int count, char** words) {
  const std::vector<std::string> given(words + 1, words + count);
  try {
    if (given.size() == 2 && given[0] == "predict") return repose::study::rehearse(given[1]);
    if (given.size() >= 6 && given[0] == "chart") return repose::study::chart(given);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  fmt::print(stderr,
             "bench_accuracy_rehearsal chart FOLDER SCENE FINEST REFERENCE SCATTER [KEY=VALUE...]\n"
             "bench_accuracy_rehearsal predict FOLDER\n");
  return 2;
}
