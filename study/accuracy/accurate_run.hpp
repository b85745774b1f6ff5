#pragma once
/// \file
/// The numbers behind `repose run SCENE --accuracy E --for QUANTITY`: chooses kernel, transfer,
/// step and cells, runs coarse and fine ones, and estimates what they tend to with an error bar.

#include <functional>
#include <optional>

#include "io/json.hpp"
#include "study/accuracy/accuracy_table.hpp"
#include "study/accuracy/decision.hpp"
#include "study/accuracy/run_cost.hpp"
#include "study/accuracy/sweep.hpp"
#include "study/accuracy/trained_domain.hpp"

namespace repose::study {

struct AccuracyGoal {
  input::SceneFile file;
  Quantity quantity = Quantity::profile;
  double target = 0.0;           ///< relative error bar
  std::optional<double> budget;  ///< CPU seconds; absent: default_budget_s
  std::filesystem::path runs;    ///< where runs lie; those that are there are not repeated
  int threads = 1;               ///< of each run
  bool resume = false;           ///< continue an interrupted run from its checkpoint
};

/// CPU seconds that own runs may take where no budget is given.
inline constexpr double default_budget_s = 600.0;

/// A way to run the scene, and what it is expected to take: the cheapest plan that meets the goal
/// where the model speaks for the scene (where there is none, the most accurate one within the
/// budget), else the sizes that its own runs will need.
struct Choice {
  Candidate candidate{};
  Plan plan;
  std::vector<double> costs;         ///< CPU seconds of one run with each size
  std::vector<std::string> reasons;  ///< why its own runs decide; empty where the model speaks
};

class AccurateRun {
 public:
  /// Makes the choice; times a few steps for it. Throws BadInput where there is no second size of
  /// cells to compare with. `goal` must outlive it.
  explicit AccurateRun(const AccuracyGoal& goal);

  const AccuracyGoal& goal() const { return goal_; }
  /// As it is run, apart from what the choice decides.
  const mpm::Scene& scene() const { return scene_; }
  const Choice& choice() const { return choice_; }
  /// Whether a choice's plan meets target and budget. What own runs will take is not known
  /// beforehand: they are never refused.
  bool meets(const Choice& choice) const;
  /// The scene is solved with an implicit viscosity, although it does not say so.
  bool made_implicit() const { return made_implicit_; }

  /// What a goal that the choice does not meet could be instead.
  struct Instead {
    Plan needed;  ///< without the budget; it may miss the target too
    Plan within;  ///< the most accurate within the budget; it may cost more than that
    std::optional<Plan> steadier;  ///< for front_99 where the front was asked for and it is enough
  };
  Instead instead() const;

  enum class End { met, missed, failed, interrupted };
  /// Runs what decision.hpp says, until the answer meets the target. A run that would exceed the
  /// budget is not begun, and one that turns out to is stopped. after_run hears of every run that
  /// came to its end. `failed`: no run came to an end, or the one that failed left no answer.
  /// Errors: IoError.
  End run(const std::function<void(const SweepRun&)>& after_run);

  const std::vector<SweepRun>& runs() const { return runs_; }
  const Convergence& convergence() const { return so_far_; }
  /// From the runs so far, of which one must have come to its end.
  Answer answer() const { return answer_of(so_far_, question_); }
  /// How often answers of this kind to this target held; absent where the scene's own runs decide.
  std::optional<Rehearsed> shown() const;
  /// The budget ended a run before its time.
  bool stopped_by_budget() const { return stopped_by_budget_; }
  /// Width of the columns that profiles are compared in [m].
  double bin() const { return sizes_.front(); }
  /// Of all runs, a stopped one included.
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
  std::vector<std::string> reasons_for(Quantity q) const;
  void estimate_costs();
  void learn_cost(const SweepRun& run);
  std::optional<Eigen::VectorXd> value_of_next(
      const Level& next, const std::function<void(const SweepRun&)>& after_run);

  const AccuracyGoal& goal_;
  mpm::Scene scene_;
  std::vector<double> sizes_;
  EstimatedCost unit_cost_;
  bool made_implicit_ = false;
  Choice choice_;
  std::vector<double> costs_;  ///< those of the choice, corrected by what runs took
  Question question_;
  Convergence so_far_;
  std::vector<SweepRun> runs_;
  double stopped_s_ = 0.0;  ///< CPU seconds of a run that the budget ended
  bool stopped_by_budget_ = false, interrupted_ = false;
};

}  // namespace repose::study
