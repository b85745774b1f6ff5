#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "calibration/path_derivatives.hpp"
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
  read_initial_freedom(table, target, e.test.initial);
  const bool sound = compared.x && compared.y.size() == target.channels.size() && !data.x.empty();
  if (sound)
    read_test(table, *compared.x, data, compared.rows, e, target);
  else
    table.table("test").expect_any();
  if (!sound || !file_.ok()) return;
  e.x = *compared.x;
  e.y = std::move(compared.y);
  e.abscissae = data.x;
  e.lines = data.lines;
  try {
    std::vector<double> start = theta_;
    complete_parameters(*out_.info, start);
    point::check_start(*out_.info, start, e.test);
    target.simulator = calibration::make_point_simulator(std::move(e));
  } catch (const InputError& error) {
    const bool parameter = point::parameter_index(out_.info->parameters, error.key()) >= 0;
    if (error.key() == "data" || error.key() == "initial")
      file_.report(error, table.path());
    else
      file_.report(error, parameter ? "fit" : join_path(table.path(), "initial"));
    return;
  }
  out_.coarse.push_back(target);
  out_.targets.push_back(std::move(target));
  out_.about.push_back(std::move(about));
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
  e.test.path = read_path(test, kind);
  if (!file_.ok()) return;
  const bool leads = calibration::leads_along(e.test.path, x);
  if (compare == Compare::distance) {
    target.compare = Compare::distance;
    e.rows = calibration::Rows::along;
  } else if (compare == Compare::interpolate || !leads) {
    target.compare = Compare::interpolate;
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
  const double strain = test.number(
      {"shear_strain", "-", "shear strain at each rate, enough to become steady", positive, 0.5});
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
