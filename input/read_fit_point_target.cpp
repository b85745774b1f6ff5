#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "calibration/path_derivatives.hpp"
#include "input/doubts.hpp"
#include "input/read_fit_target.hpp"
#include "input/read_point_test.hpp"

namespace repose::input {

using calibration::Compare;
using calibration::Target;
using point::Quantity;

void TargetReader::read_point_target(TomlReader& table, const FitTable& data, Compared compared,
                                     Target target, TargetAbout about) {
  target.inputs.resize(theta_.size() + calibration::initial_input_count, std::nan(""));
  calibration::PointExperiment e;
  e.law = out_.info;
  e.theta = theta_;
  e.test.initial = read_initial_conditions(table.table("initial"));
  e.test.settings = read_settings(table.table("integration"));
  measure_ = read_strain_measure(table, point::StrainMeasure::logarithmic);
  read_initial_freedom(table, target, e.test.initial);
  e.start_moves = !states_stress(e.test.initial) || stress_is_free(table);
  const auto asks_for_v = [&](const Quantity q) { return q == Quantity::v; };
  if (point::parameter_index(out_.info->parameters, "rho_p") < 0 &&
      ((compared.x && asks_for_v(*compared.x)) ||
       std::any_of(compared.y.begin(), compared.y.end(), asks_for_v)))
    table.report("y", fmt::format("{} has no v: {} needs rho_p, the density of its grains, for it",
                                  table.path(), out_.info->name));
  const bool sound = compared.x && compared.y.size() == target.channels.size() && !data.x.empty();
  if (sound)
    read_test(table, *compared.x, data, compared.rows, e, target);
  else
    table.table("test").expect_any();
  if (!sound || !file_.ok()) return;
  e.x = *compared.x;
  e.y = std::move(compared.y);
  e.abscissae = driven_abscissae(table, e.x, data.x);
  e.lines = data.lines;
  check_size(file_, table.path(), *out_.info, e.test);
  if (!file_.ok()) return;
  try {
    std::vector<double> start = theta_;
    complete_parameters(*out_.info, start);
    point::check_start(*out_.info, start, e.test);
    for (const std::string& doubt : doubts(*out_.info, start, e.test.initial))
      out_.notes.push_back(fmt::format("{}: {}", target.name, doubt));
    if (!e.test.path.undrained && std::find(e.y.begin(), e.y.end(), Quantity::u) != e.y.end())
      out_.notes.push_back(
          fmt::format("{}: u_Pa is fitted to a test without an undrained stage, "
                      "where the excess pore pressure is zero whatever the "
                      "parameters",
                      target.name));
    if (calibration::take_stage_strains_as_totals(e))
      out_.notes.push_back(
          fmt::format("{}: the rows do not pass stages whose strains count from "
                      "the start of the stage, but the same strains counted from "
                      "the start of the test: they are taken so (spelt ..._total)",
                      target.name));
    const bool strained = is_strain_driven(e.test.path);
    const Quantity x = e.x;
    const bool along = e.rows == calibration::Rows::along;
    // whether the data lie within reach shows in a brief look, or the fit itself will tell
    constexpr long brief_steps = 200'000;
    calibration::PointExperiment brief = e;
    brief.test.settings.max_steps =
        std::min(brief.test.settings.max_steps,
                 brief_steps / static_cast<long>(brief.test.path.legs.size()) + 100);
    about.triaxial = e.test.path.legs.back().spec().kind == point::Kind::triaxial;
    target.simulator = calibration::make_point_simulator(std::move(e));
    if (along && strained && target.compare == Compare::interpolate)
      check_reach(table, x, data, *calibration::make_point_simulator(std::move(brief)), target);
    if (!file_.ok()) return;
  } catch (const InputError& error) {
    const bool parameter = point::parameter_index(out_.info->parameters, error.key()) >= 0;
    if (error.key() == "data" || error.key() == "initial")
      file_.report(error, table.path());
    else
      file_.report(error, parameter ? "fit" : join_path(table.path(), "initial"));
    return;
  }
  about.strain = point::name_of(measure_);
  out_.coarse.push_back(target);
  out_.targets.push_back(std::move(target));
  out_.about.push_back(std::move(about));
}

/// Is the stress at the start, or a part of it, fitted?
bool TargetReader::stress_is_free(TomlReader& table) {
  TomlReader free = table.table("free");
  return free.has("p") || free.has("K0");
}

/// The data's x where the path is driven to it: logarithmic where it is a strain.
std::vector<double> TargetReader::driven_abscissae(TomlReader& table, Quantity x,
                                                   std::vector<double> values) {
  if (measure_ == point::StrainMeasure::logarithmic) return values;
  for (double& value : values) {
    const double logarithmic = point::logarithmic_strain(x, value);
    if (std::isnan(logarithmic)) {
      table.report("strain", fmt::format("{}: {} = {:g} is no engineering strain, which is below 1 "
                                         "(100 %)",
                                         table.path_of("strain"), point::column_name(x), value));
      return values;
    }
    value = logarithmic;
  }
  return values;
}

/// Are all stages driven by a strain to a strain, so that their ends hardly depend on parameters?
bool TargetReader::is_strain_driven(const point::Path& path) {
  for (const point::Leg& leg : path.legs) {
    const point::LegSpec& spec = leg.spec();
    if (!spec.goal || spec.driver < 0) return false;
    const point::Constraint& row = spec.rows[static_cast<std::size_t>(spec.driver)];
    const Quantity q = spec.goal->quantity;
    const bool strain = q == Quantity::eps_a || q == Quantity::eps_v || q == Quantity::eps_q ||
                        q == Quantity::gamma;
    if (row.stress != std::array<double, 6>{} || !strain) return false;
  }
  return !path.legs.empty();
}

/// Rows far beyond the end of a test that is driven by strain: its end is too short, whatever the
/// parameters. A tenth of the data's range is more than these move it.
void TargetReader::check_reach(TomlReader& table, Quantity x, const FitTable& data,
                               const calibration::Simulator& simulator, const Target& target) {
  std::vector<double> inputs = target.inputs;
  std::copy(theta_.begin(), theta_.end(), inputs.begin());
  calibration::Response response;
  simulator.simulate(inputs, {}, response);
  if (!response.complete() || response.x.size() < 2) return;
  const double low = response.x.minCoeff(), high = response.x.maxCoeff();
  const double slack = 0.1 * (target.x.maxCoeff() - target.x.minCoeff());
  for (std::size_t i = 0; i < data.x.size(); ++i) {
    if (data.x[i] >= low - slack && data.x[i] <= high + slack) continue;
    table.report("data",
                 fmt::format("{}: the row at {} = {:g} (line {}) lies beyond the test, which goes "
                             "from {:g} to {:g}: leave the test's end out to drive it to the last "
                             "row, or give one that reaches it",
                             table.path_of("data"), point::column_name(x), data.x[i],
                             i < data.lines.size() ? data.lines[i] : 0, low, high));
    return;
  }
}

/// free = { ocr = { lower, upper } } or { ocr = "name of a shared quantity" }
void TargetReader::read_initial_freedom(TomlReader& table, Target& target,
                                        InitialConditions& initial) {
  TomlReader free = table.table("free");
  for (int i = 0; i < calibration::initial_input_count; ++i) {
    const std::string key(calibration::initial_input_names[static_cast<std::size_t>(i)]);
    free.expect(key);
    if (!free.has(key)) continue;
    int parameter = -1;
    if (const auto name = free.get(key)->value<std::string>()) {
      const auto found = parameters_.shared().find(*name);
      if (found == parameters_.shared().end()) {
        std::vector<std::string_view> known;
        for (const auto& [shared, unused] : parameters_.shared()) known.push_back(shared);
        const std::string near = closest(*name, known);
        free.report(
            key, fmt::format("{} = \"{}\" names no quantity of [fit.shared]{}", free.path_of(key),
                             *name, near.empty() ? "" : fmt::format("; did you mean '{}'?", near)));
        continue;
      }
      parameter = found->second;
    } else {
      if (target.held_out) {
        free.report(key, fmt::format("{}: a held-out target is predicted, so nothing of its own "
                                     "can be fitted; tie it to a quantity of [fit.shared]",
                                     free.path_of(key)));
        continue;
      }
      parameter = parameters_.add_initial(free, key, target.name);
    }
    const int input = static_cast<int>(out_.info->parameters.size()) + i;
    target.bindings.push_back({input, parameter});
    const double start = start_value(out_.free[static_cast<std::size_t>(parameter)]);
    if (key == "p") initial.p = start;
    if (key == "ocr") initial.ocr = start;
    if (key == "v") initial.v = start;
    if (key == "K0") initial.K0 = start;
    if (key == "p_c0") {
      if (!initial.p)
        free.report(key, fmt::format("{} needs initial.p: ocr = p_c0/p", free.path_of(key)));
      else
        initial.ocr = std::max(1.0, start / *initial.p);
    }
  }
}

void TargetReader::read_test(TomlReader& table, Quantity x, const FitTable& data, Compare compare,
                             calibration::PointExperiment& e, Target& target) {
  TomlReader test = table.table("test");
  const auto kind_name = test.get("kind") == nullptr ? std::optional<std::string>()
                                                     : test.get("kind")->value<std::string>();
  if (kind_name == "simple_shear" && (x == Quantity::I || x == Quantity::shear_rate)) {
    read_flow_curve(test, x, data, e);
    return;
  }
  point::Kind kind = point::Kind::triaxial;
  PathReading reading;
  reading.max_strain = e.test.settings.max_strain;
  reading.measure = measure_;
  for (const double end : calibration::turning_points(target.x)) {
    point::Goal goal{x, end, false, point::StrainMeasure::logarithmic};
    if (x == Quantity::eps_q)
      goal.measure = measure_;  // located on the way
    else if (measure_ == point::StrainMeasure::engineering)
      goal.value = point::logarithmic_strain(x, end);
    reading.ends.push_back(goal);
  }
  e.test.path = read_path(test, kind, reading);
  if (!file_.ok()) return;
  e.test.path.measure = measure_;  // of the data, whatever the test's own ends are written in
  const bool leads = calibration::leads_along(e.test.path, x);
  if (compare == Compare::distance) {
    target.compare = Compare::distance;
    e.rows = calibration::Rows::along;
  } else if (compare == Compare::interpolate || !leads) {
    target.compare = Compare::interpolate;
    target.continues = true;
    e.rows = calibration::Rows::along;
    if (compare == Compare::rows)
      out_.notes.push_back(
          fmt::format("{}: {} is not what drives the test, so the simulated curve is "
                      "interpolated at the data",
                      target.name, point::column_name(x)));
  }
}

/// A flow curve: one steady shear rate per row of the data.
void TargetReader::read_flow_curve(TomlReader& test, Quantity x, const FitTable& data,
                                   calibration::PointExperiment& e) {
  test.expect("kind");
  constexpr std::array conditions{point::Condition::constant_volume,
                                  point::Condition::constant_normal_stress,
                                  point::Condition::constant_p};
  const auto condition = conditions[test.choice(
      "drainage", {"constant_volume", "constant_normal_stress", "constant_p"}, 0)];
  const double strain =
      test.number({"shear_strain", "-", "shear strain at each rate, enough to become steady",
                   Range{0.0, e.test.settings.max_strain, true, false}, 0.5});
  std::vector<double> rates = data.x;
  if (x == Quantity::I) {
    // γ̇ = I √(p/ρ_p)/d (physics.md, MUI-2), so d and ρ_p must be known
    const int d = point::parameter_index(out_.info->parameters, "d");
    const int rho = point::parameter_index(out_.info->parameters, "rho_p");
    const bool fixed = d >= 0 && rho >= 0 && e.test.initial.p &&
                       std::none_of(out_.law_key.begin(), out_.law_key.end(),
                                    [](const auto& k) { return k == "d" || k == "rho_p"; });
    if (!fixed) {
      test.report("kind",
                  "a flow curve over I needs initial.p and fixed d and rho_p; with free "
                  "ones give the data over shear_rate_per_s");
      return;
    }
    for (double& rate : rates)
      rate *= std::sqrt(*e.test.initial.p / theta_[static_cast<std::size_t>(rho)]) /
              theta_[static_cast<std::size_t>(d)];
  }
  for (const double rate : rates)
    if (!(rate > 0.0)) {
      test.report("kind",
                  fmt::format("a flow curve needs {} > 0 in every row", point::column_name(x)));
      return;
    }
  e.test.path = calibration::flow_curve_path(rates, condition, strain);
  e.rows = calibration::Rows::leg_ends;
}

}  // namespace repose::input
