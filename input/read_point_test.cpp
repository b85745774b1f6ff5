#include "input/read_point_test.hpp"

#include <cmath>
#include <system_error>

#include <fmt/format.h>

#include "input/doubts.hpp"
#include "io/atomic_file.hpp"
#include "pointdriver/path/history.hpp"

namespace repose::input {
namespace {

using point::Condition;
using point::Drive;
using point::Goal;
using point::Kind;
using point::Quantity;
using point::Stage;

/// Keys that name the end of a stage, and the quantity each is a value of.
struct GoalKey {
  std::string_view key;
  Quantity quantity;
  std::string_view unit, doc;
  bool of_stage = false;  ///< a strain that counts from the start of the stage
};
constexpr std::array goal_keys{
    GoalKey{"axial_strain", Quantity::eps_a, "-",
            "axial strain of this stage, compression positive", true},
    GoalKey{"shear_strain", Quantity::gamma, "-", "shear strain of this stage", true},
    GoalKey{"volumetric_strain", Quantity::eps_v, "-", "volumetric strain of this stage", true},
    GoalKey{"axial_strain_total", Quantity::eps_a, "-",
            "axial strain to reach, counted from the start of the test"},
    GoalKey{"shear_strain_total", Quantity::gamma, "-",
            "shear strain to reach, counted from the start of the test"},
    GoalKey{"volumetric_strain_total", Quantity::eps_v, "-",
            "volumetric strain to reach, counted from the start of the test"},
    GoalKey{"p_end", Quantity::p, "Pa", "mean stress to reach"},
    GoalKey{"q_end", Quantity::q, "Pa", "deviator stress to reach"},
    GoalKey{"sigma_a_end", Quantity::sigma_a, "Pa", "axial stress to reach"},
    GoalKey{"sigma_r_end", Quantity::sigma_r, "Pa", "radial stress to reach"},
    GoalKey{"tau_end", Quantity::tau, "Pa", "shear stress to reach"},
    GoalKey{"q_over_p_end", Quantity::eta, "-", "stress ratio to reach"}};

/// Limits of cycles: KEY_min and KEY_max.
constexpr std::array cycle_keys{
    GoalKey{"q", Quantity::q, "Pa", "of the cycles"},
    GoalKey{"p", Quantity::p, "Pa", "of the cycles"},
    GoalKey{"sigma_a", Quantity::sigma_a, "Pa", "of the cycles"},
    GoalKey{"tau", Quantity::tau, "Pa", "of the cycles"},
    GoalKey{"axial_strain", Quantity::eps_a, "-", "of the cycles", true},
    GoalKey{"shear_strain", Quantity::gamma, "-", "of the cycles", true},
    GoalKey{"volumetric_strain", Quantity::eps_v, "-", "of the cycles", true},
    GoalKey{"axial_strain_total", Quantity::eps_a, "-", "of the cycles"},
    GoalKey{"shear_strain_total", Quantity::gamma, "-", "of the cycles"},
    GoalKey{"volumetric_strain_total", Quantity::eps_v, "-", "of the cycles"}};

constexpr std::array stop_keys{
    GoalKey{"q_over_p", Quantity::eta, "-", "stop at this stress ratio"},
    GoalKey{"eps_q", Quantity::eps_q, "-", "stop at this deviatoric strain of the stage", true},
    GoalKey{"eps_v", Quantity::eps_v, "-", "stop at this volumetric strain of the stage", true},
    GoalKey{"eps_q_total", Quantity::eps_q, "-", "the same, counted from the start of the test"},
    GoalKey{"eps_v_total", Quantity::eps_v, "-", "the same, counted from the start of the test"},
    GoalKey{"p_below", Quantity::p, "Pa", "stop when p falls to this"},
    GoalKey{"p_above", Quantity::p, "Pa", "stop when p rises to this"},
    GoalKey{"q", Quantity::q, "Pa", "stop at this deviator stress"},
    GoalKey{"tau", Quantity::tau, "Pa", "stop at this shear stress"},
    GoalKey{"p_c", Quantity::p_c, "Pa", "stop at this preconsolidation pressure"}};

/// What stages inherit from the [test] table around them.
struct Inherited {
  Stage stage;
  bool drainage_given = false;
  std::optional<Drive> drive;
  PathReading reading;
};

bool is_strain(Quantity q) {
  return q == Quantity::eps_a || q == Quantity::eps_r || q == Quantity::eps_v ||
         q == Quantity::eps_q || q == Quantity::gamma;
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

Condition default_condition(Kind kind) {
  return kind == Kind::simple_shear ? Condition::constant_volume : Condition::drained;
}

Kind read_kind(TomlReader& table, std::optional<Kind> inherited) {
  constexpr std::array kinds{Kind::isotropic, Kind::oedometer, Kind::triaxial, Kind::simple_shear,
                             Kind::custom};
  const auto fallback = static_cast<std::size_t>(inherited.value_or(Kind::triaxial));
  if (!table.has("kind") && !inherited)
    table.report("kind",
                 "test.kind is missing: one of \"isotropic\", \"oedometer\", \"triaxial\", "
                 "\"simple_shear\", \"custom\"");
  return kinds[table.choice(
      "kind", {"isotropic", "oedometer", "triaxial", "simple_shear", "custom"}, fallback)];
}

void read_condition(TomlReader& table, Inherited& about) {
  Stage& stage = about.stage;
  if (stage.kind == Kind::simple_shear) {
    constexpr std::array list{Condition::constant_volume, Condition::constant_normal_stress,
                              Condition::constant_p};
    std::size_t fallback = 0;
    for (std::size_t i = 0; i < list.size(); ++i)
      if (stage.condition == list[i]) fallback = i;
    stage.condition = list[table.choice(
        "drainage", {"constant_volume", "constant_normal_stress", "constant_p"}, fallback)];
  } else if (stage.kind == Kind::triaxial) {
    constexpr std::array list{Condition::drained, Condition::undrained, Condition::constant_p,
                              Condition::drained, Condition::constant_sigma_a};
    std::size_t fallback = 0;
    for (std::size_t i = 0; i < list.size(); ++i)
      if (stage.condition == list[i]) fallback = i;
    stage.condition = list[table.choice(
        "drainage", {"drained", "undrained", "constant_p", "constant_sigma_r", "constant_sigma_a"},
        fallback)];
  }
}

std::vector<Goal> read_stops(TomlReader& table, const PathReading& reading) {
  std::vector<Goal> stops;
  if (!table.has("stop")) {
    table.expect("stop");
    return stops;
  }
  TomlReader stop = table.table("stop");
  for (const GoalKey& key : stop_keys)
    if (const auto x = stop.optional_number({key.key, key.unit, key.doc, {}, {}}))
      stops.push_back(goal_of(stop, key.key, key, *x, reading));
  return stops;
}

/// Keys that a stage shares with the table around it.
void read_shared(TomlReader& table, Inherited& about) {
  Stage& stage = about.stage;
  read_condition(table, about);
  stage.rate = table.number({"rate", "1/s", "strain rate", positive, stage.rate});
  if (stage.kind != Kind::custom)
    stage.stress_rate =
        table.number({"stress_rate", "Pa/s", "stress rate", positive, stage.stress_rate});
  stage.points =
      static_cast<int>(table.integer("points", "rows of output", 1, 1000000, stage.points));
  stage.strain_limit =
      table.number({"strain_limit", "-", "how far a stage may strain in search of its end",
                    positive, stage.strain_limit});
  check_strain(table, "strain_limit", stage.strain_limit, about.reading);
  if (table.has("control"))
    about.drive =
        table.choice("control", {"strain", "stress"}, 0) == 0 ? Drive::strain : Drive::stress;
  else
    table.expect("control");
  const std::vector<Goal> stops = read_stops(table, about.reading);
  if (!stops.empty()) stage.stops = stops;
}

/// What drives a stage of this kind towards this quantity unless `control` says otherwise.
Drive usual_drive(const Stage& stage) {
  const Quantity q = stage.goal->quantity;
  if (stage.kind == Kind::isotropic && q == Quantity::p) return Drive::stress;
  if (stage.kind == Kind::oedometer && q == Quantity::sigma_a) return Drive::stress;
  return Drive::strain;
}

std::vector<Stage> read_cycles(TomlReader& table, const Inherited& about) {
  const auto n =
      static_cast<int>(table.integer("cycles", "number of cycles", 1, 10000, std::nullopt));
  for (const GoalKey& key : cycle_keys) {
    const std::string low = std::string(key.key) + "_min", high = std::string(key.key) + "_max";
    if (!table.has(low) && !table.has(high)) continue;
    const double lower = table.number({low, key.unit, "lower limit of the cycles", {}, {}});
    const double upper = table.number({high, key.unit, "upper limit of the cycles", {}, {}});
    if (!(lower < upper)) {
      table.report(low, fmt::format("{} must be < {}", table.path_of(low), table.path_of(high)));
      return {};
    }
    const Goal down = goal_of(table, low, key, lower, about.reading);
    Stage half = about.stage;
    half.goal = goal_of(table, high, key, upper, about.reading);
    half.drive = about.drive.value_or(usual_drive(half));
    return point::cycles(half, key.quantity, down.value, half.goal->value, n, key.of_stage);
  }
  table.report("cycles",
               "cycles need limits: q_min and q_max, axial_strain_min and "
               "axial_strain_max, tau_…, p_…, sigma_a_…, shear_strain_…");
  return {};
}

std::vector<Stage> read_rates(TomlReader& table, const Inherited& about) {
  TomlReader rates = table.table("rates");
  const double from = rates.number({"from", "1/s", "slowest shear rate", positive, {}});
  const double to = rates.number({"to", "1/s", "fastest shear rate", positive, {}});
  const auto count =
      static_cast<int>(rates.integer("count", "number of rates", 2, 10000, std::nullopt));
  const double strain = table.number(
      {"shear_strain", "-", "shear strain at each rate, enough to become steady", positive, 0.5});
  check_strain(table, "shear_strain", strain, about.reading);
  if (about.stage.kind != Kind::simple_shear)
    table.report("rates", "rates belong to kind = \"simple_shear\"");
  if (!(to >= from)) rates.report("to", "test.rates.to must be >= test.rates.from");
  if (!table.file().ok()) return {};
  return point::rate_sweep(about.stage, from, to, count, strain);
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
std::vector<Stage> stages_to_data(const Inherited& about) {
  std::vector<Stage> stages;
  for (const Goal& end : about.reading.ends) {
    Stage stage = about.stage;
    stage.goal = end;
    if (!leads_surely(stage, end.quantity)) return {};
    stage.drive = about.drive.value_or(usual_drive(stage));
    stages.push_back(stage);
  }
  return stages;
}

std::vector<Stage> read_named_stage(TomlReader& table, Inherited about) {
  if (table.has("cycles")) return read_cycles(table, about);
  if (table.has("rates")) return read_rates(table, about);
  Stage& stage = about.stage;
  if (table.has("hold")) {
    stage.drive =
        table.choice("hold", {"stress", "strain"}, 0) == 0 ? Drive::creep : Drive::relaxation;
    stage.duration = table.number({"duration", "s", "how long to hold", positive, {}});
    return {stage};
  }
  for (const GoalKey& key : goal_keys) {
    const auto x = table.optional_number({key.key, key.unit, key.doc, {}, {}});
    if (!x) continue;
    if (stage.goal) {
      table.report(key.key, fmt::format("{}: a stage ends at one value; another is given too",
                                        table.path_of(key.key)));
      return {};
    }
    stage.goal = goal_of(table, key.key, key, *x, about.reading);
  }
  if (!stage.goal) {
    std::vector<Stage> stages = stages_to_data(about);
    if (stages.empty())
      table.report("",
                   fmt::format("{} says not where the stage ends: axial_strain, shear_strain, "
                               "volumetric_strain (of the stage; ..._total of the test), p_end, "
                               "q_end, sigma_a_end, tau_end, q_over_p_end, or hold with "
                               "duration, or cycles",
                               table_name(table.path())));
    return stages;
  }
  stage.drive = about.drive.value_or(usual_drive(stage));
  return {stage};
}

/// A table of components: { xx = 1e-4, xy = 0 }.
std::array<std::optional<double>, 6> read_components(TomlReader table, std::string_view unit) {
  std::array<std::optional<double>, 6> list;
  for (std::size_t i = 0; i < 6; ++i)
    list[i] = table.optional_number({point::component_names[i], unit, "component", {}, {}});
  return list;
}

point::LegSpec read_custom_stage(TomlReader& table, const Inherited& about) {
  point::LegSpec leg;
  leg.points = about.stage.points;
  leg.stops = about.stage.stops;
  leg.duration = table.number({"duration", "s", "how long the stage lasts", positive, {}});
  std::vector<point::Constraint> rows;
  if (table.has("strain_rate")) {
    const auto list = read_components(table.table("strain_rate"), "1/s");
    for (int i = 0; i < 6; ++i)
      if (const auto& x = list[static_cast<std::size_t>(i)])
        rows.push_back(point::strain_rate(i, *x));
  }
  if (table.has("stress_rate")) {
    const auto list = read_components(table.table("stress_rate"), "Pa/s");
    for (int i = 0; i < 6; ++i)
      if (const auto& x = list[static_cast<std::size_t>(i)])
        rows.push_back(point::stress_rate(i, *x));
  }
  if (table.has("constraints"))
    for (TomlReader& entry : table.tables("constraints", "a linear constraint on the rates")) {
      point::Constraint row;
      if (entry.has("strain")) {
        const auto list = read_components(entry.table("strain"), "-");
        for (std::size_t i = 0; i < 6; ++i) row.strain[i] = list[i].value_or(0.0);
      }
      if (entry.has("stress")) {
        const auto list = read_components(entry.table("stress"), "1/Pa");
        for (std::size_t i = 0; i < 6; ++i) row.stress[i] = list[i].value_or(0.0);
      }
      row.rate = entry.number({"rate", "-", "right-hand side", {}, 0.0});
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

point::Path read_history(TomlReader& table, const PathReading& reading) {
  const std::string name = table.text("history", "a CSV table");
  std::filesystem::path file = name;
  if (file.is_relative()) file = std::filesystem::path(table.file().name()).parent_path() / file;
  const auto is = table.choice("history_is", {"absolute", "change"}, 0) == 0
                      ? point::HistoryIs::absolute
                      : point::HistoryIs::change;
  try {
    return point::history_path(point::read_table(file), is, reading.measure, reading.max_strain);
  } catch (const point::TableError& error) {
    table.report("history", error.what());
  } catch (const std::system_error& error) {
    throw io::IoError(file, error.code().message());
  }
  return {};
}

}  // namespace

InitialConditions read_initial_conditions(TomlReader table) {
  InitialConditions initial;
  const Range from_one{1.0, positive.upper, false, true};
  initial.p = table.optional_number({"p", "Pa", "mean pressure", {}, {}});
  initial.sigma_v = table.optional_number(
      {"sigma_v", "Pa", "vertical stress, with K0, in place of p", positive, {}});
  initial.ocr = table.optional_number(
      {"ocr", "-", "overconsolidation ratio p_c/p, of mean stresses", from_one, {}});
  initial.ocr_v =
      table.optional_number({"ocr_v",
                             "-",
                             "overconsolidation ratio of vertical stresses, sigma_v,max/sigma_v",
                             from_one,
                             {}});
  initial.K0_nc = table.optional_number(
      {"K0_nc", "-", "ratio of radial to axial stress at sigma_v,max (default: K0)", positive, {}});
  initial.v = table.optional_number({"v", "-", "specific volume", Range{1.0, positive.upper}, {}});
  if (const auto e = table.optional_number({"e", "-", "void ratio, v = 1 + e", positive, {}})) {
    if (initial.v)
      table.report("e", fmt::format("{}: give either e or v = 1 + e", table.path_of("e")));
    initial.v = 1.0 + *e;
  }
  initial.density = table.optional_number({"density", "kg/m³", "density", positive, {}});
  initial.K0 = table.optional_number({"K0", "-", "ratio of radial to axial stress", positive, {}});
  if (const auto sigma = table.numbers(
          {"sigma", "Pa", "xx, yy, zz, xy, yz, zx, compression positive", {}, {}}, 6)) {
    initial.sigma.emplace();
    std::copy(sigma->begin(), sigma->end(), initial.sigma->begin());
  }
  return initial;
}

point::StrainMeasure read_strain_measure(TomlReader& table, point::StrainMeasure fallback) {
  constexpr std::array measures{point::StrainMeasure::logarithmic,
                                point::StrainMeasure::engineering};
  return measures[table.choice("strain", {"logarithmic", "engineering"},
                               fallback == point::StrainMeasure::logarithmic ? 0 : 1)];
}

point::Settings read_settings(TomlReader table) {
  point::Settings settings;
  constexpr std::array methods{point::Method::adaptive, point::Method::implicit,
                               point::Method::cvode,    point::Method::ida,
                               point::Method::arkode,   point::Method::automatic};
  settings.method = methods[table.choice(
      "method", {"adaptive", "implicit", "cvode", "ida", "arkode", "automatic"}, 5)];
  settings.tolerance = table.number({"tolerance", "-", "relative error per step",
                                     Range{1e-14, 0.1, false, false}, settings.tolerance});
  settings.substeps = static_cast<int>(
      table.integer("substeps", "implicit: steps per row", 1, 1000000, settings.substeps));
  settings.max_steps =
      table.integer("max_steps", "steps per stage", 1, 1000000000, settings.max_steps);
  settings.max_strain = table.number({"max_strain", "-", "a path that strains further has run away",
                                      positive, settings.max_strain});
  return settings;
}

point::Path read_path(TomlReader test, Kind& kind, const PathReading& reading) {
  Inherited about;
  about.reading = reading;
  about.reading.measure = read_strain_measure(test, reading.measure);
  kind = read_kind(test, std::nullopt);
  about.stage.kind = kind;
  about.stage.condition = default_condition(kind);
  const auto custom = [&](TomlReader& table, Inherited inherited) {
    return read_custom_stage(table, inherited);
  };
  try {
    if (test.has("history")) {
      if (kind != Kind::custom) test.report("history", "a history belongs to kind = \"custom\"");
      return read_history(test, about.reading);
    }
    read_shared(test, about);
    std::vector<Stage> stages;
    std::vector<point::LegSpec> legs;
    if (!test.has("stages")) {
      if (kind == Kind::custom)
        legs.push_back(custom(test, about));
      else
        stages = read_named_stage(test, about);
    } else {
      for (TomlReader& table : test.tables("stages", "a stage of the test")) {
        Inherited own = about;
        own.reading.ends.clear();
        own.stage.kind = read_kind(table, kind);
        if ((own.stage.kind == Kind::custom) != (kind == Kind::custom)) {
          table.report("kind", "custom and named stages cannot be mixed in one test");
          continue;
        }
        if (own.stage.kind != kind) own.stage.condition = default_condition(own.stage.kind);
        read_shared(table, own);
        if (kind == Kind::custom) {
          legs.push_back(custom(table, own));
        } else {
          const std::vector<Stage> more = read_named_stage(table, own);
          stages.insert(stages.end(), more.begin(), more.end());
        }
      }
    }
    if (!test.file().ok()) return {};
    point::Path path =
        kind == Kind::custom ? point::custom_path(std::move(legs)) : point::path_of(stages);
    path.measure = about.reading.measure;
    return path;
  } catch (const InputError& error) {
    test.file().report(error, test.path());
    return {};
  }
}

PointTestFile read_point_test(InputFile& file) {
  PointTestFile result;
  result.name = std::filesystem::path(file.name()).stem().string();
  TomlReader root(file);
  result.law = read_law(root.table("law"));
  result.test.initial = read_initial_conditions(root.table("initial"));
  result.test.settings = read_settings(root.table("integration"));
  PathReading reading;
  reading.max_strain = result.test.settings.max_strain;
  result.test.path = read_path(root.table("test"), result.kind, reading);
  file.throw_if_bad();
  const LawInfo& law = find_law(result.law);
  const point::Method method = point::method_for(law, result.test.settings.method);
  if (!law.has_stress_memory && method != point::Method::implicit)
    file.report("integration.method",
                fmt::format("the stress of {} ({}) follows the strain rate at once, so there is no "
                            "rate to integrate: use method = \"implicit\"",
                            law.name, law.option));
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
