#include "input/read_point_test.hpp"

#include <cmath>

#include <fmt/core.h>

#include "input/doubts.hpp"
#include "input/history_table.hpp"
#include "input/read_initial.hpp"
#include "input/read_keys.hpp"
#include "input/read_sensitivity.hpp"
#include "input/read_sweep.hpp"
#include "input/test_keys.hpp"
#include "pointdriver/path/history.hpp"

namespace repose::input {
namespace {

using point::Condition;
using point::Drive;
using point::Goal;
using point::Kind;
using point::Quantity;
using point::Stage;

bool is_strain(Quantity q) {
  return q == Quantity::eps_a || q == Quantity::eps_r || q == Quantity::eps_v ||
         q == Quantity::eps_q || q == Quantity::gamma;
}

/// What a test writes at most: 10^6 rows are a quarter of a gigabyte, and as much again as text.
constexpr std::size_t most_rows = 1'000'000;
/// Stages, half cycles and rates of a test; each is some kilobytes before it is driven.
constexpr std::size_t most_legs = 20'000;
/// Steps that method = "implicit" takes at least, substeps by row: minutes.
constexpr double most_implicit_steps = 1e9;

std::string too_many_rows(double rows) {
  return fmt::format(
      "the test writes {:.0f} rows, and {} are the most: fewer points per stage, or "
      "fewer stages and cycles",
      rows, most_rows);
}

/// 15 under a key that is a strain: per cent are meant.
void check_strain(TomlReader& table, std::string_view key, double x, const PathReading& reading) {
  if (std::abs(x) <= reading.max_strain) return;
  table.report(key,
               fmt::format("{} = {:g} is {:g} %; did you mean {:g}? Strains are fractions, and "
                           "a path ends at integration.max_strain = {:g}",
                           table.path_of(key), x, 100.0 * x, 0.01 * x, reading.max_strain));
}

/// A goal as a key gives it, in logarithmic strain where it is driven to.
Goal goal_of(TomlReader& table, std::string_view key, const GoalKey& about, double x,
             const PathReading& reading) {
  Goal goal{about.quantity, x, about.of_stage, point::StrainMeasure::logarithmic};
  if (!is_strain(about.quantity)) return goal;
  check_strain(table, key, x, reading);
  if (reading.measure == point::StrainMeasure::logarithmic) return goal;
  if (about.quantity == Quantity::eps_q) {
    goal.measure = reading.measure;
    return goal;
  }
  goal.value = point::logarithmic_strain(about.quantity, x);
  if (std::isnan(goal.value)) {
    table.report(key, fmt::format("{} = {:g}: an engineering strain is below 1 (100 %)",
                                  table.path_of(key), x));
    goal.value = 0.0;
  }
  return goal;
}

/// What a stage is before its end is known.
Stage stage_of(TomlReader& table, const StageTable& given, const PathReading& reading) {
  Stage stage;
  stage.kind = given.kind;
  stage.condition = given.condition;
  stage.rate = given.rate;
  stage.stress_rate = given.stress_rate;
  stage.points = given.points;
  stage.strain_limit = given.strain_limit;
  check_strain(table, "strain_limit", stage.strain_limit, reading);
  for (std::size_t i = 0; i < stop_keys.size(); ++i)
    if (given.stops[i])
      stage.stops.push_back(goal_of(table, "stop." + std::string(stop_keys[i].key), stop_keys[i],
                                    *given.stops[i], reading));
  return stage;
}

/// What drives a stage towards its end: `control`, or what is usual for its kind.
Drive drive_of(const Stage& stage, const StageTable& given) {
  if (given.control) return *given.control == Control::strain ? Drive::strain : Drive::stress;
  const Quantity q = stage.goal->quantity;
  if (stage.kind == Kind::isotropic && q == Quantity::p) return Drive::stress;
  if (stage.kind == Kind::oedometer && q == Quantity::sigma_a) return Drive::stress;
  return Drive::strain;
}

std::vector<Stage> cycles_of(TomlReader& table, const StageTable& given,
                             const PathReading& reading) {
  for (std::size_t i = 0; i < cycle_keys.size(); ++i) {
    const GoalKey& key = cycle_keys[i];
    const std::string low = std::string(key.key) + "_min", high = std::string(key.key) + "_max";
    if (!given.lowest[i] && !given.highest[i]) continue;
    if (!given.lowest[i] || !given.highest[i]) {
      table.report("cycles", fmt::format("cycles between {} and {} need both", low, high));
      return {};
    }
    if (!(*given.lowest[i] < *given.highest[i])) {
      table.report(low, fmt::format("{} must be < {}", table.path_of(low), table.path_of(high)));
      return {};
    }
    const Goal down = goal_of(table, low, key, *given.lowest[i], reading);
    Stage half = stage_of(table, given, reading);
    half.goal = goal_of(table, high, key, *given.highest[i], reading);
    half.drive = drive_of(half, given);
    return point::cycles(half, key.quantity, down.value, half.goal->value,
                         static_cast<int>(*given.cycles), key.of_stage);
  }
  table.report("cycles",
               "cycles need limits: q_min and q_max, axial_strain_min and "
               "axial_strain_max, tau_…, p_…, sigma_a_…, shear_strain_…");
  return {};
}

std::vector<Stage> rates_of(TomlReader& table, const StageTable& given,
                            const PathReading& reading) {
  constexpr std::size_t shear_strain = 1;
  static_assert(goal_keys[shear_strain].key == "shear_strain");
  const double strain = given.goals[shear_strain].value_or(0.5);
  check_strain(table, "shear_strain", strain, reading);
  if (!(strain > 0.0)) table.report("shear_strain", "the strain at each rate must be > 0");
  if (!(given.fastest >= given.slowest))
    table.report("rates", fmt::format("{} must be >= {}", table.path_of("rates.to"),
                                      table.path_of("rates.from")));
  if (!table.file().ok()) return {};
  return point::rate_sweep(stage_of(table, given, reading), given.slowest, given.fastest,
                           given.rates, strain);
}

/// Is this a quantity that the stage leads to whichever way it is driven?
bool leads_surely(const Stage& stage, Quantity q) {
  switch (stage.kind) {
    case Kind::triaxial:
      return q == Quantity::eps_a || q == Quantity::eps_q || q == Quantity::q;
    case Kind::isotropic:
      return q == Quantity::p || q == Quantity::eps_v;
    case Kind::oedometer:
      return q == Quantity::sigma_a || q == Quantity::eps_a || q == Quantity::eps_v;
    case Kind::simple_shear:
      return q == Quantity::gamma || q == Quantity::tau;
    case Kind::custom:
      break;
  }
  return false;
}

/// A test without an end of its own, driven to where the data turn round and to their last row.
std::vector<Stage> stages_to_data(TomlReader& table, const StageTable& given,
                                  const PathReading& reading) {
  std::vector<Stage> stages;
  for (const Goal& end : reading.ends) {
    Stage stage = stage_of(table, given, reading);
    stage.goal = end;
    if (!leads_surely(stage, end.quantity)) return {};
    stage.drive = drive_of(stage, given);
    stages.push_back(stage);
  }
  return stages;
}

std::vector<Stage> stages_of(TomlReader& table, const StageTable& given,
                             const PathReading& reading) {
  if (given.cycles) return cycles_of(table, given, reading);
  if (given.sweeps) return rates_of(table, given, reading);
  Stage stage = stage_of(table, given, reading);
  if (given.hold) {
    stage.drive = *given.hold == Control::stress ? Drive::creep : Drive::relaxation;
    stage.duration = given.duration;
    return {stage};
  }
  std::string_view first;
  for (std::size_t i = 0; i < goal_keys.size(); ++i) {
    if (!given.goals[i]) continue;
    const GoalKey& key = goal_keys[i];
    if (stage.goal) {
      table.report(key.key,
                   fmt::format("{}: a stage ends at one value, and {} is given too; leave one out",
                               table.path_of(key.key), table.path_of(first)));
      return {};
    }
    first = key.key;
    stage.goal = goal_of(table, key.key, key, *given.goals[i], reading);
  }
  if (!stage.goal) {
    std::vector<Stage> stages = stages_to_data(table, given, reading);
    if (stages.empty())
      table.report("",
                   fmt::format("{} says not where the stage ends: axial_strain, shear_strain, "
                               "volumetric_strain (of the stage; ..._total of the test), p_end, "
                               "q_end, sigma_a_end, tau_end, q_over_p_end, or hold with "
                               "duration, or cycles",
                               table_name(table.path())));
    return stages;
  }
  stage.drive = drive_of(stage, given);
  return {stage};
}

/// Six rows of mixed control.
point::LegSpec leg_of(TomlReader& table, const StageTable& given, const PathReading& reading) {
  const Stage stage = stage_of(table, given, reading);
  point::LegSpec leg;
  leg.points = stage.points;
  leg.stops = stage.stops;
  leg.duration = given.duration;
  std::vector<point::Constraint> rows;
  for (std::size_t i = 0; i < 6; ++i) {
    if (given.strain_rate[i])
      rows.push_back(point::strain_rate(static_cast<int>(i), *given.strain_rate[i]));
    if (given.stress_rates[i])
      rows.push_back(point::stress_rate(static_cast<int>(i), *given.stress_rates[i]));
  }
  for (const StageTable::Constraint& constraint : given.constraints) {
    point::Constraint row;
    for (std::size_t i = 0; i < 6; ++i) {
      row.strain[i] = constraint.strain[i].value_or(0.0);
      row.stress[i] = constraint.stress[i].value_or(0.0);
    }
    row.rate = constraint.rate;
    rows.push_back(row);
  }
  if (rows.size() != 6) {
    table.report("", fmt::format("{}: strain_rate, stress_rate and constraints together give {} "
                                 "rows, and six are needed (one per component xx, yy, zz, xy, yz, "
                                 "zx, or a linear constraint in its place)",
                                 table_name(table.path()), rows.size()));
    return leg;
  }
  std::copy(rows.begin(), rows.end(), leg.rows.begin());
  return leg;
}

point::Path history_of(TomlReader& table, const TestTable& test, const PathReading& reading) {
  const auto history = read_history_table(table, test.history);
  if (!history) return {};
  try {
    return point::history_path(*history, test.history_is, reading.measure, reading.max_strain);
  } catch (const point::TableError& error) {
    table.report("history", error.what());
  }
  return {};
}

}  // namespace

void check_size(InputFile& file, const std::string& table, const LawInfo& law,
                const point::PointTest& test) {
  const auto key = [&](std::string_view name) { return join_path(table, name); };
  const std::size_t rows = test.path.row_count();
  if (rows > most_rows) file.report(key("test.points"), too_many_rows(static_cast<double>(rows)));
  const double steps = static_cast<double>(rows) * test.settings.substeps;
  const point::Method method = point::method_for(law, test.settings.method);
  if (method == point::Method::implicit && steps > most_implicit_steps)
    file.report(key("integration.substeps"),
                fmt::format("{} rows of {} substeps are {:.2g} steps, and {:g} are the most", rows,
                            test.settings.substeps, steps, most_implicit_steps));
}

InitialConditions read_initial_conditions(TomlReader table) {
  InitialConditions initial;
  ReadKeys keys(std::move(table));
  initial_keys(keys, initial);
  return initial;
}

point::StrainMeasure read_strain_measure(TomlReader& table, point::StrainMeasure fallback) {
  ReadKeys keys(table);
  strain_key(keys, fallback);
  return fallback;
}

point::Settings read_settings(TomlReader table) {
  point::Settings settings;
  ReadKeys keys(std::move(table));
  integration_keys(keys, settings);
  return settings;
}

point::Path read_path(TomlReader table, Kind& kind, const PathReading& about) {
  TestTable test;
  test.measure = about.measure;
  PathReading reading = about;
  std::vector<Stage> stages;
  std::vector<point::LegSpec> legs;
  double rows = 0.0;
  /// What a stage says, as a part of the path.
  const auto add = [&](TomlReader& at, const StageTable& given, const PathReading& how) {
    if (given.kind == Kind::custom) {
      legs.push_back(leg_of(at, given, how));
    } else {
      // before they are made: each takes some kilobytes
      const double asked = given.sweeps   ? static_cast<double>(given.rates)
                           : given.cycles ? 2.0 * static_cast<double>(*given.cycles)
                                          : 1.0;
      if (static_cast<double>(stages.size()) + asked > most_legs) {
        at.report(
            given.cycles   ? "cycles"
            : given.sweeps ? "rates"
                           : "",
            fmt::format("the test has more than {} stages, half cycles and rates", most_legs));
        return;
      }
      rows += asked * given.points;
      if (rows > most_rows) {
        at.report("points", too_many_rows(rows));
        return;
      }
      const std::vector<Stage> more = stages_of(at, given, how);
      stages.insert(stages.end(), more.begin(), more.end());
    }
  };
  ReadKeys keys(table);
  try {
    test_keys(keys, test, [&](Keys& below, std::size_t) {
      StageTable own = test.shared;
      stage_keys(below, own);
      if ((own.kind == Kind::custom) != (test.shared.kind == Kind::custom)) {
        below.reader()->report("kind", "custom and named stages cannot be mixed in one test");
        return;
      }
      PathReading how = reading;
      how.measure = test.measure;
      how.ends.clear();
      add(*below.reader(), own, how);
    });
    kind = test.shared.kind;
    reading.measure = test.measure;
    if (!test.history.empty()) return history_of(table, test, reading);
    if (!table.has("stages")) add(table, test.shared, reading);
    if (!table.file().ok()) return {};
    point::Path path =
        kind == Kind::custom ? point::custom_path(std::move(legs)) : point::path_of(stages);
    path.measure = reading.measure;
    return path;
  } catch (const InputError& error) {
    table.file().report(error, table.path());
    return {};
  }
}

std::vector<KeyInfo> point_test_infos() {
  LawSpec law;
  InitialConditions initial;
  TestTable test;
  point::Settings settings;
  return describe_keys([&](Keys& keys) {
    keys.table(
        {"law",
         "-",
         "the constitutive law; or a file with a [law] table, as a fit leaves it: \"fitted.toml\"",
         {},
         required},
        [&](Keys& below) { law_keys(below, law); });
    keys.table({"initial", "-", "the state at the start"},
               [&](Keys& below) { initial_keys(below, initial); });
    keys.table({"test", "-", "the path", {}, required},
               [&](Keys& below) { test_keys(below, test); });
    keys.table({"integration", "-", "how the path is integrated"},
               [&](Keys& below) { integration_keys(below, settings); });
    sweep_keys(keys);
    sensitivity_keys(keys);
    std::vector<double> secants_at;
    keys.table({"report", "-", "figures for summary.json beside the usual ones"},
               [&](Keys& below) { report_keys(below, secants_at); });
  });
}

PointTestFile read_point_test(InputFile& file) {
  PointTestFile result;
  result.name = std::filesystem::path(file.name()).stem().string();
  TomlReader root(file);
  root.expect("sweep");        // read_sweep.hpp
  root.expect("sensitivity");  // read_sensitivity.hpp
  result.law = read_law(root.table("law"));
  result.test.initial = read_initial_conditions(root.table("initial"));
  result.test.settings = read_settings(root.table("integration"));
  ReadKeys report(root.table("report"));
  report_keys(report, result.secants_at);
  PathReading reading;
  reading.max_strain = result.test.settings.max_strain;
  result.test.path = read_path(root.table("test"), result.kind, reading);
  file.throw_if_bad();
  const LawInfo& law = find_law(result.law);
  const point::Method method = point::method_for(law, result.test.settings.method);
  if (point::method_for(law, point::Method::automatic) == point::Method::implicit &&
      method != point::Method::implicit)
    file.report("integration.method",
                law.has_stress_memory
                    ? fmt::format("{} has an update and no rate to integrate: use method = "
                                  "\"implicit\"",
                                  law.name)
                    : fmt::format("the stress of {} ({}) follows the strain rate at once, so "
                                  "there is no rate to integrate: use method = \"implicit\"",
                                  law.name, law.option));
  check_size(file, "", law, result.test);
  try {
    point::check_start(law, checked_parameters(result.law), result.test);
  } catch (const InputError& error) {
    const bool parameter = point::parameter_index(law.parameters, error.key()) >= 0;
    file.report(error, parameter ? "law" : error.key() == "history" ? "test" : "initial");
  }
  file.throw_if_bad();
  result.notes = doubts(law, checked_parameters(result.law), result.test.initial);
  return result;
}

}  // namespace repose::input
