#include "pointdriver/work_precision.hpp"

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

/// p, q and ε_v row by row
struct Response {
  std::vector<double> p, q, eps_v;
};

Response response(const LawInfo& law, std::span<const double> theta, const PointTest& test,
                  const Curve& curve) {
  Response r;
  read_column(law, theta, test, curve, Quantity::p, r.p);
  read_column(law, theta, test, curve, Quantity::q, r.q);
  read_column(law, theta, test, curve, Quantity::eps_v, r.eps_v);
  return r;
}

double distance(const Response& a, const Response& reference) {
  if (a.p.size() != reference.p.size()) return std::numeric_limits<double>::quiet_NaN();
  double worst = 0.0;
  double volume = 1e-3;  // where the volume is kept, its error counts against 0.1 %
  for (const double x : reference.eps_v) volume = std::max(volume, std::abs(x));
  for (std::size_t i = 0; i < a.p.size(); ++i)
    worst = std::max({worst, std::abs(a.p[i] - reference.p[i]) / reference.p[i],
                      std::abs(a.q[i] - reference.q[i]) / reference.p[i],
                      std::abs(a.eps_v[i] - reference.eps_v[i]) / volume});
  return worst;
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
  return {
      {"undrained, normally consolidated", law,
       test_of({triaxial_to(Condition::undrained, 0.1)}, 1.0)},
      {"undrained, OCR 8", law, test_of({triaxial_to(Condition::undrained, 0.1)}, 8.0)},
      {"drained, normally consolidated", law, test_of({triaxial_to(Condition::drained, 0.2)}, 1.0)},
      {"drained, OCR 8", law, test_of({triaxial_to(Condition::drained, 0.2)}, 8.0)},
      {"isotropic load, unload, reload", law, test_of(loop, 1.5)},
      {"one-dimensional compression", law, test_of({oedometer}, 1.2)},
  };
}

std::vector<WorkPoint> work_precision(const WorkPath& path, double seconds_each) {
  const LawInfo& law = find_law(path.law);
  const std::vector<double> theta = checked_parameters(path.law);
  PointTest test = path.test;
  Curve curve;
  test.settings.method = Method::adaptive;
  test.settings.tolerance = 1e-13;
  simulate(law, theta, test, curve);
  const Response reference = response(law, theta, test, curve);

  std::vector<WorkPoint> points;
  const auto measure = [&](Method method, double tolerance, int substeps) {
    test.settings.method = method;
    test.settings.tolerance = tolerance;
    test.settings.substeps = substeps;
    WorkPoint point;
    point.path = path.name;
    point.method = method;
    point.tolerance = tolerance;
    point.substeps = substeps;
    point.seconds = std::numeric_limits<double>::infinity();
    const double start = clock_seconds();
    for (int i = 0; i < 1000 && (i < 3 || clock_seconds() - start < seconds_each); ++i) {
      const double before = clock_seconds();
      simulate(law, theta, test, curve);
      point.seconds = std::min(point.seconds, clock_seconds() - before);
    }
    point.completed = curve.outcome.status == Status::completed;
    point.error = distance(response(law, theta, test, curve), reference);
    point.steps = curve.outcome.counts.steps;
    point.rates = curve.outcome.counts.rates;
    points.push_back(point);
  };
  for (const Method method : {Method::adaptive, Method::cvode, Method::ida, Method::arkode})
    for (int digit = 3; digit <= 12; ++digit) {
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
