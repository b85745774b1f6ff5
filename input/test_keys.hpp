#pragma once
/// \file
/// What a [test] table says, before it becomes a path (read_point_test.hpp).

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "input/keys.hpp"
#include "pointdriver/path/history.hpp"
#include "pointdriver/path/laboratory.hpp"

namespace repose::input {

/// A key that names the end of a stage, and the quantity it is a value of.
struct GoalKey {
  std::string_view key;
  point::Quantity quantity;
  std::string_view unit, doc;
  bool of_stage = false;  ///< a strain that counts from the start of the stage
};

inline constexpr std::array goal_keys{
    GoalKey{"axial_strain", point::Quantity::eps_a, "-",
            "axial strain of this stage, compression positive", true},
    GoalKey{"shear_strain", point::Quantity::gamma, "-",
            "shear strain of this stage, or at each of the rates (0.5)", true},
    GoalKey{"volumetric_strain", point::Quantity::eps_v, "-", "volumetric strain of this stage",
            true},
    GoalKey{"axial_strain_total", point::Quantity::eps_a, "-",
            "axial strain to reach, counted from the start of the test"},
    GoalKey{"shear_strain_total", point::Quantity::gamma, "-",
            "shear strain to reach, counted from the start of the test"},
    GoalKey{"volumetric_strain_total", point::Quantity::eps_v, "-",
            "volumetric strain to reach, counted from the start of the test"},
    GoalKey{"p_end", point::Quantity::p, "Pa", "mean stress to reach"},
    GoalKey{"q_end", point::Quantity::q, "Pa", "deviator stress to reach"},
    GoalKey{"sigma_a_end", point::Quantity::sigma_a, "Pa", "axial stress to reach"},
    GoalKey{"sigma_r_end", point::Quantity::sigma_r, "Pa", "radial stress to reach"},
    GoalKey{"tau_end", point::Quantity::tau, "Pa", "shear stress to reach"},
    GoalKey{"q_over_p_end", point::Quantity::eta, "-", "stress ratio to reach"}};

/// Limits of cycles: KEY_min and KEY_max.
inline constexpr std::array cycle_keys{
    GoalKey{"q", point::Quantity::q, "Pa", "limit of the cycles"},
    GoalKey{"p", point::Quantity::p, "Pa", "limit of the cycles"},
    GoalKey{"sigma_a", point::Quantity::sigma_a, "Pa", "limit of the cycles"},
    GoalKey{"tau", point::Quantity::tau, "Pa", "limit of the cycles"},
    GoalKey{"axial_strain", point::Quantity::eps_a, "-", "limit, from where the cycles begin",
            true},
    GoalKey{"shear_strain", point::Quantity::gamma, "-", "limit, from where the cycles begin",
            true},
    GoalKey{"volumetric_strain", point::Quantity::eps_v, "-", "limit, from where the cycles begin",
            true},
    GoalKey{"axial_strain_total", point::Quantity::eps_a, "-", "limit, from the start of the test"},
    GoalKey{"shear_strain_total", point::Quantity::gamma, "-", "limit, from the start of the test"},
    GoalKey{"volumetric_strain_total", point::Quantity::eps_v, "-",
            "limit, from the start of the test"}};

inline constexpr std::array stop_keys{
    GoalKey{"q_over_p", point::Quantity::eta, "-", "stop at this stress ratio"},
    GoalKey{"eps_q", point::Quantity::eps_q, "-", "stop at this deviatoric strain of the stage",
            true},
    GoalKey{"eps_v", point::Quantity::eps_v, "-", "stop at this volumetric strain of the stage",
            true},
    GoalKey{"eps_q_total", point::Quantity::eps_q, "-",
            "the same, counted from the start of the test"},
    GoalKey{"eps_v_total", point::Quantity::eps_v, "-",
            "the same, counted from the start of the test"},
    GoalKey{"p_below", point::Quantity::p, "Pa", "stop when p falls to this"},
    GoalKey{"p_above", point::Quantity::p, "Pa", "stop when p rises to this"},
    GoalKey{"q", point::Quantity::q, "Pa", "stop at this deviator stress"},
    GoalKey{"tau", point::Quantity::tau, "Pa", "stop at this shear stress"},
    GoalKey{"p_c", point::Quantity::p_c, "Pa", "stop at this preconsolidation pressure"}};

using Values = std::array<std::optional<double>, 6>;  ///< of xx, yy, zz, xy, yz, zx

enum class Control : std::uint8_t { strain, stress };

/// A test or one of its stages.
struct StageTable {
  point::Kind kind = point::Kind::triaxial;
  point::Condition condition = point::Condition::drained;
  std::optional<Control> control;
  double rate = point::Stage{}.rate;
  double stress_rate = point::Stage{}.stress_rate;
  double strain_limit = point::Stage{}.strain_limit;
  int points = point::Stage{}.points;
  std::array<std::optional<double>, stop_keys.size()> stops{};

  std::array<std::optional<double>, goal_keys.size()> goals{};
  std::optional<std::int64_t> cycles;
  std::array<std::optional<double>, cycle_keys.size()> lowest{}, highest{};
  bool sweeps = false;  ///< `rates` is given
  double slowest = 0.0, fastest = 0.0;
  int rates = 0;
  std::optional<Control> hold;
  double duration = 0.0;

  struct Constraint {
    Values strain{}, stress{};
    double rate = 0.0;
  };
  Values strain_rate{}, stress_rates{};
  std::vector<Constraint> constraints;
};

struct TestTable {
  point::StrainMeasure measure = point::StrainMeasure::logarithmic;
  std::string history;
  point::HistoryIs history_is = point::HistoryIs::absolute;
  StageTable shared;
};

/// The keys of [test]; those of each of its stages, which inherit what the test says, are left to
/// `stage`.
void test_keys(Keys& keys, TestTable& test,
               const std::function<void(Keys&, std::size_t)>& stage = {});
/// The keys of one of [[test.stages]]; `stage` holds what it inherits.
void stage_keys(Keys& keys, StageTable& stage);

void strain_key(Keys& keys, point::StrainMeasure& measure);
/// Figures that a report wants beside the usual ones.
void report_keys(Keys& keys, std::vector<double>& secants_at);
void integration_keys(Keys& keys, point::Settings& settings);

}  // namespace repose::input
