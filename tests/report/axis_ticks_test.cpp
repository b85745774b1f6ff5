#include "report/plot/axis_ticks.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include <gtest/gtest.h>

namespace repose::report {
namespace {

std::vector<std::string> labels(const std::vector<Tick>& ticks) {
  std::vector<std::string> out;
  for (const Tick& tick : ticks)
    if (!tick.label.empty()) out.push_back(tick.label);
  return out;
}

using Labels = std::vector<std::string>;

TEST(LinearTicks, ReadableNumbers) {
  EXPECT_EQ(labels(linear_ticks(0.0, 1.2, 6)),
            (Labels{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0", "1.2"}));
  EXPECT_EQ(labels(linear_ticks(-0.03, 0.16, 4)), (Labels{"0.00", "0.05", "0.10", "0.15"}));
  EXPECT_EQ(labels(linear_ticks(-250.0, 130.0, 4)), (Labels{"−200", "−100", "0", "100"}));
  EXPECT_EQ(labels(linear_ticks(0.0, 3.1e6, 4)), (Labels{"0", "1×10^{6}", "2×10^{6}", "3×10^{6}"}));
  EXPECT_EQ(labels(linear_ticks(0.0, 1.1e-5, 3)), (Labels{"0", "0.5×10^{−5}", "1.0×10^{−5}"}));
  EXPECT_EQ(labels(linear_ticks(-0.06, 0.46, 2)), (Labels{"0.0", "0.2", "0.4"}));
}

TEST(LinearTicks, AtLeastTwoWithinAnyRange) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-12.0, 12.0), mantissa(-1.0, 1.0);
  for (int k = 0; k < 2000; ++k) {
    const double lower = mantissa(random) * std::pow(10.0, exponent(random));
    const double upper = lower + std::abs(lower) * 1e-6 + std::pow(10.0, exponent(random));
    for (const int target : {1, 2, 5, 9}) {
      const auto ticks = linear_ticks(lower, upper, target);
      ASSERT_GE(ticks.size(), 2u) << lower << " " << upper << " " << target;
      ASSERT_LE(ticks.size(), static_cast<std::size_t>(std::max(target, 4)) + 1);
      // Ticks are k·step, and k·step at an end of the range is allowed 1e-9 of a step beyond it.
      const double slack = 1e-8 * (upper - lower);
      for (const Tick& tick : ticks) {
        ASSERT_GE(tick.value, lower - slack);
        ASSERT_LE(tick.value, upper + slack);
      }
    }
  }
}

// Ends that differ in the last bits, not at all, or that are no numbers: no step fits, and none is
// counted for ever.
TEST(LinearTicks, AnyRangeEnds) {
  const double next = std::nextafter(100.0, 200.0);
  for (const auto& [lower, upper] :
       std::vector<std::pair<double, double>>{{100.0, next},
                                              {100.0, 100.0},
                                              {100.0, 100.0 + 64.0 * (next - 100.0)},
                                              {0.0, 0.0},
                                              {-next, -100.0},
                                              {0.0, std::numeric_limits<double>::infinity()},
                                              {std::nan(""), 1.0},
                                              {2.0, 1.0},
                                              {0.0, 1e-300},
                                              {-1e300, 1e300},
                                              {0.0, std::numeric_limits<double>::denorm_min()}})
    for (const int target : {1, 2, 5, 9}) {
      const auto ticks = linear_ticks(lower, upper, target);
      EXPECT_LE(ticks.size(), 20u) << lower << " " << upper;
      for (const Tick& tick : ticks) EXPECT_TRUE(std::isfinite(tick.value));
    }
}

TEST(LogarithmicTicks, PowersOfTenOverManyDecades) {
  const auto ticks = logarithmic_ticks(2e-4, 3.0, 6);
  EXPECT_EQ(labels(ticks), (Labels{"10^{−3}", "10^{−2}", "10^{−1}", "10^{0}"}));
  // 3..9·10⁻⁴ and 2·10⁻⁴ are 8 marks, three whole decades have 8 between powers, 2 and 3 follow 1.
  EXPECT_EQ(ticks.size(), 8u + 4u + 3u * 8u + 2u);
  EXPECT_EQ(labels(logarithmic_ticks(1e-12, 1.0, 6)).size(), 5u);  // every third power
}

TEST(LogarithmicTicks, PlainNumbersOverFewDecades) {
  EXPECT_EQ(labels(logarithmic_ticks(8.0, 600.0, 6)),
            (Labels{"10", "20", "50", "100", "200", "500"}));
  EXPECT_EQ(labels(logarithmic_ticks(0.03, 0.3, 6)), (Labels{"0.05", "0.1", "0.2"}));
  EXPECT_EQ(labels(logarithmic_ticks(9e4, 6e5, 6)), (Labels{"10^{5}", "2×10^{5}", "5×10^{5}"}));
  EXPECT_EQ(labels(logarithmic_ticks(2.1, 4.4, 3)), (Labels{"3", "4"}));  // nearly linear
}

}  // namespace
}  // namespace repose::report
