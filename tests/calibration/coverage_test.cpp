// 200 repeats of a twin experiment with 1 % noise: how often the 95 % intervals hold the truth.

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include "calibration/uncertainty.hpp"
#include "study/fit/twin.hpp"

namespace repose::calibration {
namespace {

TEST(Coverage, IntervalsHoldTheTruthIn90To99PercentOf200Repeats) {
  const study::Twin twin = study::cam_clay_twin();
  std::vector<study::TwinTest> tests = study::cam_clay_tests();
  constexpr int repeats = 200;
  std::vector<std::array<int, 5>> hit(repeats);
  tbb::parallel_for(0, repeats, [&](int k) {
    const Problem problem =
        study::twin_problem(twin, tests, 0.01, static_cast<std::uint64_t>(k + 1));
    const Eigen::VectorXd z = problem.space().coordinates(twin.truth_vector());
    const Optimum o = levenberg_marquardt(problem, z);
    const Uncertainty u = uncertainty(problem, o.z);
    for (std::size_t i = 0; i < 5; ++i)
      hit[static_cast<std::size_t>(k)][i] =
          u.interval[i][0] <= twin.truth[i] && twin.truth[i] <= u.interval[i][1] ? 1 : 0;
  });
  for (std::size_t i = 0; i < 5; ++i) {
    int hits = 0;
    for (const auto& h : hit) hits += h[i];
    const double share = hits / static_cast<double>(repeats);
    std::printf("[ measured ] %s: %.1f %% of %d\n", twin.free[i].name.c_str(), 100.0 * share,
                repeats);
    // 95 % with a binomial scatter of √(0.95·0.05/200) = 1.5 %: 90 to 99 % is −3.2 to +2.6 of it
    EXPECT_GE(share, 0.90) << twin.free[i].name;
    EXPECT_LE(share, 0.99) << twin.free[i].name;
  }
}

}  // namespace
}  // namespace repose::calibration
