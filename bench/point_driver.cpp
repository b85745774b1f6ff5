// The point driver's figures: stress updates per second, whole tests per second. Each path reports
// its error against the closed form (undrained) or a reference at 1e-13.
//   build/bench/bin/bench_point_driver --benchmark_repetitions=5
#include <benchmark/benchmark.h>

#include "models/all_laws.hpp"
#include "models/registry.hpp"
#include "models/scalar.hpp"
#include "pointdriver/integrate/sensitivity.hpp"
#include "tests/pointdriver/exact_solutions.hpp"

namespace {

using namespace repose;
using namespace repose::point;

constexpr exact::CamClay london{0.888, 0.161, 0.062, 0.3, true};

const LawSpec& spec() {
  static const LawSpec law{
      "modified_cam_clay",
      {{"compression", "v-ln_p"}},
      {{"M", 0.888}, {"lambda", 0.161}, {"kappa", 0.062}, {"nu", 0.3}, {"Gamma", 2.759}}};
  return law;
}

using Clay = ModifiedCamClay<Compression::v_ln_p>;

/// Points normally consolidated at 100 kPa, strained by 1e-3 in triaxial compression: every update
/// is plastic.
struct Points {
  std::vector<double> theta = checked_parameters(spec());
  Clay::Params<double> P = Clay::Params<double>::from(std::span<const double>(theta));
  InitialPoint start;
  Points() {
    InitialConditions given;
    given.p = 100e3;
    given.ocr = 1.0;
    start = Clay::initial(P, given);
  }
};

void update_one_at_a_time(benchmark::State& bench) {
  const Points points;
  constexpr std::size_t count = 256;
  std::vector<Increment<double, 4>> increments(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double a = 1e-3 * (0.5 + static_cast<double>(i) / count);
    increments[i].strain.c = {0.4 * a, -a, 0.4 * a, 0.1 * a};
    increments[i].dt = 1.0;
    increments[i].density = points.start.density * std::exp(0.2 * a);
  }
  for (auto _ : bench)
    for (std::size_t i = 0; i < count; ++i) {
      Sym<double, 4> stress = Sym<double, 4>::isotropic(-100e3);
      Clay::State<double> state{points.start.state[0], 0.0};
      benchmark::DoNotOptimize(Clay::update(points.P, increments[i], stress, state));
      benchmark::DoNotOptimize(stress);
    }
  bench.SetItemsProcessed(bench.iterations() * static_cast<std::int64_t>(count));
}
BENCHMARK(update_one_at_a_time);

void update_in_batches(benchmark::State& bench) {
  const Points points;
  const auto material = make_material(spec());
  constexpr std::size_t count = 256;
  constexpr std::size_t room = padded(count);
  std::array<std::vector<double>, 4> strain, stress;
  std::vector<double> density(room, points.start.density), p_c(room, points.start.state[0]),
      rho_sep(room, 0.0);
  Batch batch;
  batch.count = count;
  batch.dt = 1.0;
  for (std::size_t k = 0; k < 4; ++k) {
    strain[k].resize(room);
    stress[k].assign(room, k < 3 ? -100e3 : 0.0);
    for (std::size_t i = 0; i < room; ++i) {
      const double a = 1e-3 * (0.5 + static_cast<double>(i) / count);
      strain[k][i] = std::array{0.4, -1.0, 0.4, 0.1}[k] * a;
    }
    batch.strain[k] = strain[k].data();
    batch.stress[k] = stress[k].data();
  }
  batch.density = density.data();
  batch.state = {p_c.data(), rho_sep.data()};
  for (auto _ : bench) {
    for (std::size_t k = 0; k < 4; ++k)
      std::fill(stress[k].begin(), stress[k].end(), k < 3 ? -100e3 : 0.0);
    std::fill(density.begin(), density.end(), points.start.density);
    std::fill(p_c.begin(), p_c.end(), points.start.state[0]);
    benchmark::DoNotOptimize(material->update(batch));
    benchmark::ClobberMemory();
  }
  bench.SetItemsProcessed(bench.iterations() * static_cast<std::int64_t>(count));
}
BENCHMARK(update_in_batches);

PointTest triaxial_test(Condition condition, double strain, double ocr, int rows, Method method,
                        double tolerance) {
  Stage stage;
  stage.condition = condition;
  stage.goal = Goal{Quantity::eps_a, strain};
  stage.points = rows;
  PointTest test;
  test.path = path_of({stage});
  test.initial.p = 100e3;
  test.initial.ocr = ocr;
  test.settings.method = method;
  test.settings.tolerance = tolerance;
  test.settings.energy = false;
  return test;
}

/// 10 % strain undrained, ten rows; the error is that of p and q at every row.
void undrained_path(benchmark::State& bench, Method method, double tolerance, double ocr) {
  const LawInfo& law = find_law(spec());
  const std::vector<double> theta = checked_parameters(spec());
  const PointTest test = triaxial_test(Condition::undrained, 0.1, ocr, 10, method, tolerance);
  Curve curve;
  for (auto _ : bench) benchmark::DoNotOptimize(simulate(law, theta, test, curve));
  double error = 0.0;
  for (const Row<double>& row : curve.rows) {
    const double v0 = theta[7] / curve.rows.front().density;
    const exact::Point e = exact::undrained(london, 100e3, ocr, v0, -row.strain[1]);
    const double p = pressure(row.stress);
    error = std::max(
        {error, std::abs(p - e.p) / e.p, std::abs(row.stress[0] - row.stress[1] - e.q) / e.p});
  }
  bench.counters["error"] = error;
  bench.counters["steps"] = static_cast<double>(curve.outcome.counts.steps);
}
BENCHMARK_CAPTURE(undrained_path, adaptive_1e_6, Method::adaptive, 1e-6, 1.0);
BENCHMARK_CAPTURE(undrained_path, adaptive_1e_7, Method::adaptive, 1e-7, 1.0);
BENCHMARK_CAPTURE(undrained_path, adaptive_1e_7_ocr_8, Method::adaptive, 1e-7, 8.0);
BENCHMARK_CAPTURE(undrained_path, cvode_1e_7, Method::cvode, 1e-7, 1.0);
BENCHMARK_CAPTURE(undrained_path, ida_1e_7, Method::ida, 1e-7, 1.0);

void drained_test_200_rows(benchmark::State& bench, Method method, double tolerance, double ocr) {
  const LawInfo& law = find_law(spec());
  const std::vector<double> theta = checked_parameters(spec());
  const PointTest test = triaxial_test(Condition::drained, 0.2, ocr, 200, method, tolerance);
  Curve curve;
  for (auto _ : bench) benchmark::DoNotOptimize(simulate(law, theta, test, curve));
  bench.counters["rows"] = static_cast<double>(curve.rows.size());
  bench.counters["steps"] = static_cast<double>(curve.outcome.counts.steps);
}
BENCHMARK_CAPTURE(drained_test_200_rows, adaptive_1e_8, Method::adaptive, 1e-8, 1.0);
BENCHMARK_CAPTURE(drained_test_200_rows, adaptive_1e_8_ocr_8, Method::adaptive, 1e-8, 8.0);
BENCHMARK_CAPTURE(drained_test_200_rows, cvode_1e_8, Method::cvode, 1e-8, 1.0);

void drained_test_with_gradient(benchmark::State& bench) {
  const LawInfo& law = find_law(spec());
  std::vector<double> theta = checked_parameters(spec());
  theta[5] = std::numeric_limits<double>::quiet_NaN();  // N follows from Gamma
  const std::vector<int> which{0, 1, 2, 3};
  const PointTest test = triaxial_test(Condition::drained, 0.2, 1.0, 50, Method::adaptive, 1e-8);
  GradientCurve curve;
  for (auto _ : bench)
    benchmark::DoNotOptimize(simulate_with_gradient(law, theta, which, test, curve));
}
BENCHMARK(drained_test_with_gradient);

}  // namespace
