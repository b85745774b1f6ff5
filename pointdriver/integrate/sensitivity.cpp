#include "pointdriver/integrate/sensitivity.hpp"

#include "pointdriver/integrate/dual_start.hpp"
#include "pointdriver/integrate/gradient.hpp"
#include "pointdriver/integrate/library_drives.hpp"
#include "pointdriver/integrate/outside_driver.hpp"
#include "pointdriver/integrate/plain_rows.hpp"

namespace repose::point {

namespace {

/// Of a law from outside: the numbers go out and come back as plain ones.
Outcome drive_outside(const LawInfo& law, std::span<const double> theta, std::span<const int> which,
                      const PointTest& test, GradientCurve& curve) {
  const OutsideDriver& driver = outside_driver(law);
  const auto start_at = [&](std::span<const double> at) { return driver.start(at, test); };
  const std::vector<double> flat = start_at(theta);
  if (!suits(test.path, std::span(flat).subspan(law.parameters.size(), 6))) return curve.outcome;
  std::vector<double> slopes(OutsideDriver::slope_width * flat.size(), 0.0);
  for (std::size_t j = 0; j < which.size(); ++j) {
    const std::vector<double> slope = flat_slope(start_at, theta, which[j], flat);
    std::copy(slope.begin(), slope.end(),
              slopes.begin() + static_cast<std::ptrdiff_t>(j * flat.size()));
  }
  Curve values;
  std::vector<Curve> slope_curves;
  driver.drive(flat, slopes, test, values, slope_curves);
  join(values, slope_curves, curve);
  return curve.outcome;
}

}  // namespace

Outcome simulate_with_gradient(const LawInfo& law, std::span<const double> theta,
                               std::span<const int> which, const PointTest& test,
                               GradientCurve& curve) {
  curve.rows.clear();
  curve.outcome = {};
  curve.outcome.status = Status::bad_initial;
  if (which.size() > static_cast<std::size_t>(gradient_width)) {
    curve.outcome.status = Status::unsupported;
    return curve.outcome;
  }
  if (find_outside(law) != nullptr) outside_driver(law);  // says so where it has none
  try {
    return visit_law(
        law,
        [&]<class L>(L) -> Outcome {
          const ElementStart<L, Gradient> start = dual_start<L, Gradient>(theta, which, test);
          std::array<double, 6> stress{};
          for (std::size_t i = 0; i < 6; ++i) stress[i] = start.stress_and_state[i].a;
          if (suits(test.path, stress))
            return drive_path<L, Gradient>(start, test.path, test.settings, curve);
          return curve.outcome;
        },
        [&] { return drive_outside(law, theta, which, test, curve); });
  } catch (const InputError&) {
    return curve.outcome;
  }
}

void read_column_with_gradient(const LawInfo& law, std::span<const double> theta,
                               std::span<const int> which, const PointTest& test,
                               const GradientCurve& curve, Quantity quantity,
                               std::vector<double>& values, std::vector<double>& derivatives) {
  values.clear();
  derivatives.clear();
  if (curve.rows.empty()) return;
  Readout<Gradient> readout;
  readout.frame = test.path.frame;
  readout.measure = test.path.measure;
  const auto constant = [&](std::string_view name, Gradient& into) {
    const int i = parameter_index(law.parameters, name);
    if (i < 0) return;
    into = Gradient(theta[static_cast<std::size_t>(i)]);
    for (std::size_t j = 0; j < which.size(); ++j)
      if (which[j] == i) into.v[static_cast<int>(j)] = 1.0;
  };
  constant("rho_p", readout.rho_p);
  constant("d", readout.d);
  find_variables(law.state, law.derived, readout);
  set_pore_pressure_datum(curve.rows, test.path.first_undrained, readout);
  for (const Row<Gradient>& row : curve.rows) {
    const Gradient x = read(quantity, row, readout);
    values.push_back(x.a);
    for (std::size_t j = 0; j < which.size(); ++j) derivatives.push_back(x.v[static_cast<int>(j)]);
  }
}

Outcome simulate_columns_with_gradient(const LawInfo& law, std::span<const double> theta,
                                       std::span<const int> which, const PointTest& test,
                                       std::span<const Quantity> quantities,
                                       std::vector<GradientColumn>& columns) {
  columns.assign(quantities.size(), {});
  Outcome outcome;
  GradientCurve curve;
  std::vector<double> part;
  for (std::size_t first = 0; first == 0 || first < which.size(); first += gradient_width) {
    const auto wanted =
        which.subspan(first, std::min<std::size_t>(gradient_width, which.size() - first));
    outcome = simulate_with_gradient(law, theta, wanted, test, curve);
    for (std::size_t c = 0; c < quantities.size(); ++c) {
      GradientColumn& column = columns[c];
      read_column_with_gradient(law, theta, wanted, test, curve, quantities[c], column.values,
                                part);
      column.derivatives.resize(column.values.size() * which.size());
      for (std::size_t row = 0; row < column.values.size(); ++row)
        for (std::size_t j = 0; j < wanted.size(); ++j)
          column.derivatives[row * which.size() + first + j] = part[row * wanted.size() + j];
    }
  }
  return outcome;
}

}  // namespace repose::point
