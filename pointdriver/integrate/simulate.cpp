#include "pointdriver/integrate/simulate.hpp"

#include <cstdio>

#include "pointdriver/integrate/library_drives.hpp"
#include "pointdriver/integrate/outside_driver.hpp"
#include "pointdriver/integrate/start.hpp"

namespace repose::point {
namespace {

std::string digits(double x) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", x);
  return text.data();
}

/// The stress in the numbers that a path starts from (flat_start).
std::span<const double> stress_of(const LawInfo& law, const std::vector<double>& numbers) {
  return std::span(numbers).subspan(law.parameters.size(), 6);
}

}  // namespace

Outcome simulate(const LawInfo& law, std::span<const double> theta, const PointTest& test,
                 Curve& curve) {
  const auto bad_initial = [&] {
    curve.rows.clear();
    curve.outcome = {};
    curve.outcome.status = Status::bad_initial;
    return curve.outcome;
  };
  return visit_law(
      law,
      [&]<class L>(L) -> Outcome {
        try {
          const ElementStart<L, double> start = plain_start<L>(theta, test);
          if (suits(test.path, start.stress_and_state))
            return drive_path<L, double>(start, test.path, test.settings, curve);
        } catch (const InputError&) {
        }
        return bad_initial();
      },
      [&]() -> Outcome {
        const OutsideDriver& driver = outside_driver(law);
        try {
          const std::vector<double> numbers = driver.start(theta, test);
          if (suits(test.path, stress_of(law, numbers))) return driver.drive(numbers, test, curve);
        } catch (const InputError&) {
        }
        return bad_initial();
      });
}

void read_column(const LawInfo& law, std::span<const double> theta, const PointTest& test,
                 const Curve& curve, Quantity quantity, std::vector<double>& values) {
  Readout<double> readout;
  readout.frame = test.path.frame;
  readout.measure = test.path.measure;
  if (const int i = parameter_index(law.parameters, "rho_p"); i >= 0)
    readout.rho_p = theta[static_cast<std::size_t>(i)];
  if (const int i = parameter_index(law.parameters, "d"); i >= 0)
    readout.d = theta[static_cast<std::size_t>(i)];
  find_variables(law.state, law.derived, readout);
  values.clear();
  values.reserve(curve.rows.size());
  if (curve.rows.empty()) return;
  set_pore_pressure_datum(curve.rows, test.path.first_undrained, readout);
  for (const Row<double>& row : curve.rows) values.push_back(read(quantity, row, readout));
}

std::vector<Quantity> columns_of(const LawInfo& law, const PointTest& test) {
  using Q = Quantity;
  std::vector<Q> columns{Q::time, Q::eps_a, Q::eps_r, Q::eps_v, Q::eps_q};
  const bool shear = test.path.frame != Frame::axisymmetric;
  if (shear) columns.push_back(Q::gamma);
  for (const Q q : {Q::p, Q::q, Q::sigma_a, Q::sigma_r}) columns.push_back(q);
  if (shear) columns.push_back(Q::tau);
  if (test.path.undrained) columns.push_back(Q::u);
  if (parameter_index(law.parameters, "rho_p") >= 0) columns.push_back(Q::v);
  if (variable_index(law, "p_c") >= 0) columns.push_back(Q::p_c);
  if (variable_index(law, "I") >= 0 || (shear && parameter_index(law.parameters, "d") >= 0))
    columns.push_back(Q::I);
  if (shear) {
    columns.push_back(Q::mu);
  }
  return columns;
}

Method method_for(const LawInfo& law, Method method) {
  return visit_law(
      law, [&]<class L>(L) { return chosen_method<L>(method); },
      [&] { return outside_driver(law).method_for(method); });
}

std::string_view name_of(Method method) {
  constexpr std::array<std::string_view, 6> names{"automatic", "adaptive", "implicit",
                                                  "cvode",     "ida",      "arkode"};
  return names[static_cast<std::size_t>(method)];
}

std::optional<Method> find_method(std::string_view name) {
  for (const Method m : {Method::automatic, Method::adaptive, Method::implicit, Method::cvode,
                         Method::ida, Method::arkode})
    if (name_of(m) == name) return m;
  return std::nullopt;
}

double start_value(const LawInfo& law, std::span<const double> theta, const PointTest& test,
                   Quantity quantity) {
  return visit_law(
      law,
      [&]<class L>(L) {
        const ElementStart<L, double> start = plain_start<L>(theta, test);
        Row<double> row;
        for (std::size_t i = 0; i < 6; ++i) row.stress.c[i] = start.stress_and_state[i];
        row.state = variables<L>(start.parameters, start.stress_and_state);
        row.density = start.density;
        return read(quantity, row, make_readout(start, test.path.frame));
      },
      [&] {
        const std::vector<double> numbers = outside_driver(law).start(theta, test);
        Curve curve;
        Row<double>& row = curve.rows.emplace_back();
        for (std::size_t i = 0; i < 6; ++i) row.stress.c[i] = stress_of(law, numbers)[i];
        for (std::size_t i = 0; i < std::min(law.state.size(), max_state); ++i)
          row.state[i] = numbers[law.parameters.size() + 6 + i];
        row.density = numbers.back();
        std::vector<double> value;
        read_column(law, theta, test, curve, quantity, value);
        return value.front();
      });
}

void check_start(const LawInfo& law, std::span<const double> theta, const PointTest& test) {
  const auto check = [&](std::span<const double> stress) {
    if (const StartClaim* claim = contradicted(test.path, stress)) {
      const bool of_stress = claim->of.stress != std::array<double, 6>{};
      throw InputError("history", claim->table + ": the first row says " + claim->column + " = " +
                                      digits(claim->value) + (of_stress ? " Pa" : "") +
                                      ", and the test starts at " +
                                      digits(claimed_quantity(*claim, stress)) +
                                      (of_stress ? " Pa: give the same stress in [initial]"
                                                 : ": strains are zero at the start") +
                                      ", or history_is = \"change\" if only the differences count");
    }
    if (!suits(test.path, stress))
      throw InputError(test.initial.sigma ? "sigma" : "initial",
                       "this test needs an initial stress with equal radial stresses (xx = zz) and "
                       "no shear components");
  };
  visit_law(
      law, [&]<class L>(L) { check(plain_start<L>(theta, test).stress_and_state); },
      [&] { check(stress_of(law, outside_driver(law).start(theta, test))); });
}

}  // namespace repose::point
