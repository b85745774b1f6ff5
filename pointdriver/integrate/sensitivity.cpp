#include "pointdriver/integrate/sensitivity.hpp"

#include "pointdriver/integrate/dual_start.hpp"

namespace repose::point {

Outcome simulate_with_gradient(const LawInfo& law, std::span<const double> theta,
                               std::span<const int> which, const PointTest& test,
                               GradientCurve& curve) {
  return visit_law(law, [&]<class L>(L) -> Outcome {
    curve.rows.clear();
    curve.outcome = {};
    curve.outcome.status = Status::bad_initial;
    if (which.size() > static_cast<std::size_t>(gradient_width)) {
      curve.outcome.status = Status::unsupported;
      return curve.outcome;
    }
    try {
      const ElementStart<L, Gradient> start = dual_start<L, Gradient>(theta, which, test);
      std::array<double, 6> stress{};
      for (std::size_t i = 0; i < 6; ++i) stress[i] = start.stress_and_state[i].a;
      if (suits(test.path, stress))
        return drive_path<L, Gradient>(start, test.path, test.settings, curve);
    } catch (const InputError&) {
    }
    return curve.outcome;
  });
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
  const auto constant = [&](std::string_view name, Gradient& into) {
    const int i = parameter_index(law.parameters, name);
    if (i < 0) return;
    into = Gradient(theta[static_cast<std::size_t>(i)]);
    for (std::size_t j = 0; j < which.size(); ++j)
      if (which[j] == i) into.v[static_cast<int>(j)] = 1.0;
  };
  constant("rho_p", readout.rho_p);
  constant("d", readout.d);
  readout.p_c_index = state_index(law.state, "p_c");
  set_pore_pressure_datum(curve.rows, test.path.first_undrained, readout);
  for (const Row<Gradient>& row : curve.rows) {
    const Gradient x = read(quantity, row, readout);
    values.push_back(x.a);
    for (std::size_t j = 0; j < which.size(); ++j) derivatives.push_back(x.v[static_cast<int>(j)]);
  }
}

}  // namespace repose::point
