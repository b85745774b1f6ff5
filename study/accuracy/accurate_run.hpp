#pragma once
/// \file
/// The numbers behind `repose run SCENE --accuracy E --for QUANTITY`: chooses kernel, transfer,
/// step and cells, runs coarse and fine ones, and estimates what they tend to with an error bar.

#include <functional>
#include <optional>

#include "io/json.hpp"
#include "study/accuracy/accuracy_table.hpp"
#include "study/accuracy/sweep.hpp"

namespace repose::study {

struct AccuracyGoal {
  input::SceneFile file;
  Quantity quantity = Quantity::profile;
  double target = 0.0;           ///< relative error bar
  std::optional<double> budget;  ///< CPU seconds
  std::filesystem::path runs;    ///< where runs lie; those that are there are not repeated
  int threads = 1;               ///< of each run
  bool resume = false;           ///< continue an interrupted run from its checkpoint
};

/// A way to run the scene, and the cheapest plan with it that meets the goal; where there is none,
/// the most accurate one within the budget.
struct Choice {
  Candidate candidate{};
  Plan plan;
  std::vector<double> costs;  ///< CPU seconds of one run with each size
  bool measured = true;       ///< false: the errors of another law stand in
};

class AccurateRun {
 public:
  /// Makes the choice; times a few steps for it. Throws BadInput where there is no second size of
  /// cells to compare with. `goal` must outlive it.
  explicit AccurateRun(const AccuracyGoal& goal);

  const AccuracyGoal& goal() const { return goal_; }
  const Choice& choice() const { return choice_; }
  /// Whether a choice's plan meets target and budget.
  bool meets(const Choice& choice) const;

  /// What a goal that the choice does not meet could be instead.
  struct Instead {
    Plan needed;  ///< without the budget; it may miss the target too
    Plan within;  ///< the most accurate within the budget; it may cost more than that
    std::optional<Plan> steadier;  ///< for front_99 where the front was asked for and it is enough
  };
  Instead instead() const;

  enum class End { met, missed, failed, interrupted };
  /// Runs the plan, made anew after every run, until the error bar meets the target. after_run
  /// hears of every run that came to its end. Errors: IoError.
  End run(const std::function<void(const SweepRun&)>& after_run);

  const std::vector<SweepRun>& runs() const { return runs_; }
  const Convergence& convergence() const { return so_far_; }
  /// Width of the columns that profiles are compared in [m].
  double bin() const { return sizes_.front(); }
  double cpu_s() const;
  double point_steps() const;
  /// Where the far wall has stopped the front, it no longer tells how far the material runs.
  bool front_at_far_wall() const;
  /// Relative distance of the finest cells' mean from the estimate.
  double finest_alone(const Estimate& estimate) const;
  /// The scene with the finest settings used.
  input::SceneFile advised() const;

  /// summary.json without what only an end that was reached has.
  io::Json summary(const std::string& status, std::uint64_t seed) const;
  /// accuracy.csv: a row per run. estimate.csv: the quantity with its error bar, or the curve.
  std::string runs_csv(const Estimate& estimate) const;
  std::string estimate_csv(const Estimate& estimate) const;

 private:
  Choice choose(Quantity q) const;
  void learn_cost(const SweepRun& run);

  const AccuracyGoal& goal_;
  const mpm::Scene& scene_;
  double budget_;
  std::vector<double> sizes_;
  std::vector<double> unit_costs_;  ///< CPU seconds of one run with each size, Courant number 1
  Choice choice_;
  std::vector<double> costs_;  ///< those of the choice, corrected by what runs took
  Convergence so_far_;
  std::vector<SweepRun> runs_;
};

}  // namespace repose::study
