#include "pointdriver/study/work_precision.hpp"

#include <array>
#include <chrono>

namespace repose::point {
namespace {

LawSpec london_clay(const char* compression) {
  // Schofield & Wroth 1968; nu assumed
  return {"modified_cam_clay",
          {{"compression", compression}},
          {{"M", 0.888}, {"lambda", 0.161}, {"kappa", 0.062}, {"nu", 0.3}, {"Gamma", 2.759}}};
}

constexpr int rows = 50;

Stage triaxial_to(Condition condition, double strain) {
  Stage stage;
  stage.condition = condition;
  stage.goal = Goal{Quantity::eps_a, strain};
  stage.points = rows;
  return stage;
}

PointTest test_of(const std::vector<Stage>& stages, double ocr) {
  PointTest test;
  test.path = path_of(stages);
  test.initial.p = 100e3;
  test.initial.ocr = ocr;
  test.settings.energy = false;
  return test;
}

double clock_seconds() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

/// Quantities of a row beside its stress: each is compared over its largest in the reference.
constexpr std::size_t others = max_state + 7;
std::array<double, others> others_of(const Row<double>& row) {
  std::array<double, others> x{};
  for (std::size_t k = 0; k < max_state; ++k) x[k] = row.state[k];
  x[max_state] = row.density;
  for (int k = 0; k < 6; ++k) x[max_state + 1 + static_cast<std::size_t>(k)] = row.strain[k];
  return x;
}

/// Fills in a point's errors; NaN where the rows differ in number.
void compare(const Curve& curve, const Curve& reference, WorkPoint& point) {
  point.stress_error = point.state_error = std::numeric_limits<double>::quiet_NaN();
  if (curve.rows.size() != reference.rows.size()) return;
  double stress = 0.0;
  std::array<double, others> size{};
  for (const Row<double>& row : reference.rows) {
    stress = std::max(stress, norm(row.stress));
    const auto x = others_of(row);
    for (std::size_t k = 0; k < others; ++k) size[k] = std::max(size[k], std::abs(x[k]));
  }
  // all components of strain over the largest of them: some are zero on purpose
  const auto first = size.begin() + max_state + 1;
  std::fill(first, size.end(), *std::max_element(first, size.end()));
  point.stress_error = point.state_error = 0.0;
  for (std::size_t i = 0; i < curve.rows.size(); ++i) {
    const Row<double>&a = curve.rows[i], &b = reference.rows[i];
    const double scale = std::max(norm(b.stress), 1e-3 * stress);  // a start without stress
    point.stress_error = std::max(point.stress_error, norm(a.stress - b.stress) / scale);
    const auto x = others_of(a), y = others_of(b);
    for (std::size_t k = 0; k < others; ++k)
      if (size[k] > 0.0)
        point.state_error = std::max(point.state_error, std::abs(x[k] - y[k]) / size[k]);
  }
}

/// The q-quantile of sorted numbers.
double quantile(const std::vector<double>& sorted, double q) {
  const double at = q * static_cast<double>(sorted.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  if (i + 1 == sorted.size()) return sorted.back();
  return sorted[i] + (at - static_cast<double>(i)) * (sorted[i + 1] - sorted[i]);
}

Stage shear_to(Condition condition, double gamma) {
  Stage stage;
  stage.kind = Kind::simple_shear;
  stage.condition = condition;
  stage.rate = 10.0;
  stage.goal = Goal{Quantity::gamma, gamma};
  stage.points = rows;
  return stage;
}

/// Sheared at 10/s.
PointTest shear_test(Condition condition, double p, double gamma) {
  PointTest test;
  test.path = path_of({shear_to(condition, gamma)});
  test.initial.p = p;
  test.settings.energy = false;
  return test;
}

}  // namespace

std::vector<WorkPath> work_paths() {
  std::vector<Stage> loop;
  for (const double target : {400e3, 25e3, 800e3}) {
    Stage stage;
    stage.kind = Kind::isotropic;
    stage.drive = Drive::stress;
    stage.goal = Goal{Quantity::p, target};
    stage.points = rows / 3;
    loop.push_back(stage);
  }
  Stage oedometer;
  oedometer.kind = Kind::oedometer;
  oedometer.drive = Drive::stress;
  oedometer.goal = Goal{Quantity::sigma_a, 1e6};
  oedometer.points = rows;
  const LawSpec law = london_clay("v-ln_p");
  LawSpec other_form = london_clay("ln_v-ln_p");  // as compressible at v = 2.2
  for (const char* name : {"lambda", "kappa"}) other_form.values[name] /= 2.2;
  // the paper's grains: flow sets in at gamma = mu_0 p/G = 4e-4
  const LawSpec grains{"mu_i",
                       {{"form", "elastoviscoplastic"}},
                       {{"mu_0", 0.3819},
                        {"mu_d", 0.5718},
                        {"I_0", 0.279},
                        {"d", 0.0053},
                        {"rho_p", 2000.0},
                        {"rho_0", 1300.0},
                        {"K", 254800.0}}};
  const LawSpec rubber{"neo_hookean", {}, {{"E", 1e6}, {"nu", 0.3}, {"rho_0", 1000.0}}};
  return {
      {"undrained, normally consolidated", law,
       test_of({triaxial_to(Condition::undrained, 0.1)}, 1.0)},
      {"undrained, OCR 8", law, test_of({triaxial_to(Condition::undrained, 0.1)}, 8.0)},
      {"drained, normally consolidated", law, test_of({triaxial_to(Condition::drained, 0.2)}, 1.0)},
      {"drained, OCR 8", law, test_of({triaxial_to(Condition::drained, 0.2)}, 8.0)},
      {"isotropic load, unload, reload", law, test_of(loop, 1.5)},
      {"one-dimensional compression", law, test_of({oedometer}, 1.2)},
      {"undrained, ln v - ln p", other_form,
       test_of({triaxial_to(Condition::undrained, 0.1)}, 1.0)},
      {"mu(I), sheared at constant volume", grains,
       shear_test(Condition::constant_volume, 1e3, 2e-3)},
      {"mu(I), sheared under constant stress", grains,
       shear_test(Condition::constant_normal_stress, 1e3, 2e-3)},
      {"neo-Hookean, sheared", rubber, shear_test(Condition::constant_volume, 100e3, 0.05)},
  };
}

std::vector<WorkPoint> work_precision(const WorkPath& path, const WorkEffort& effort) {
  const LawInfo& law = find_law(path.law);
  const std::vector<double> theta = checked_parameters(path.law);
  PointTest test = path.test;
  Curve curve, reference;
  test.settings.method = Method::adaptive;
  test.settings.tolerance = 1e-13;
  simulate(law, theta, test, reference);

  std::vector<WorkPoint> points;
  std::vector<double> times;
  const auto measure = [&](Method method, double tolerance, int substeps) {
    test.settings.method = method;
    test.settings.tolerance = tolerance;
    test.settings.substeps = substeps;
    WorkPoint point;
    point.path = path.name;
    point.method = method;
    point.tolerance = tolerance;
    point.substeps = substeps;
    times.clear();
    const double start = clock_seconds();
    for (int i = 0; i < 1000 && (i < 3 || clock_seconds() - start < effort.seconds_each); ++i) {
      const double before = clock_seconds();
      simulate(law, theta, test, curve);
      times.push_back(clock_seconds() - before);
    }
    std::sort(times.begin(), times.end());
    point.seconds = quantile(times, 0.5);
    point.lower = quantile(times, 0.25);
    point.upper = quantile(times, 0.75);
    point.repeats = static_cast<int>(times.size());
    point.completed = curve.outcome.status == Status::completed;
    compare(curve, reference, point);
    point.steps = curve.outcome.counts.steps;
    point.rates = curve.outcome.counts.rates;
    points.push_back(point);
  };
  for (const Method method : {Method::adaptive, Method::cvode, Method::ida, Method::arkode})
    for (int digit = 3; digit <= 12; digit += effort.digits_apart) {
      if (method == Method::arkode && digit > 10) continue;
      measure(method, std::pow(10.0, -digit), 0);
    }
  for (int substeps = 1; substeps <= 256; substeps *= 4) measure(Method::implicit, 1e-8, substeps);
  return points;
}

std::vector<StepError> step_error_map(const LawInfo& law, std::span<const double> theta,
                                      const InitialConditions& start, double reach, int n) {
  std::vector<StepError> map;
  map.reserve(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  PointTest test;
  test.initial = start;
  test.settings.energy = false;
  Curve one, exact;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double eps_v = reach * (2.0 * i / (n - 1) - 1.0);
      const double eps_q = reach * j / (n - 1);
      StepError cell{eps_v, eps_q, std::numeric_limits<double>::quiet_NaN()};
      // ε_a = ε_v/3 + ε_q, ε_r = ε_v/3 − ε_q/2
      LegSpec leg;
      for (int c = 0; c < 6; ++c)
        leg.rows[static_cast<std::size_t>(c)] = strain_rate(
            c, c == 1 ? eps_v / 3.0 + eps_q : (c == 0 || c == 2 ? eps_v / 3.0 - 0.5 * eps_q : 0.0));
      leg.duration = 1.0;
      test.path = custom_path({leg});
      test.settings.method = Method::implicit;
      test.settings.substeps = 1;
      const bool done = simulate(law, theta, test, one).status == Status::completed;
      test.settings.method = Method::adaptive;
      test.settings.tolerance = 1e-11;
      if (done && simulate(law, theta, test, exact).status == Status::completed) {
        const Sym<double, 6>& reference = exact.rows.back().stress;
        const Sym<double, 6> miss = one.rows.back().stress - reference;
        cell.error = std::sqrt(contract(miss, miss) / contract(reference, reference));
      }
      map.push_back(cell);
    }
  return map;
}

}  // namespace repose::point
