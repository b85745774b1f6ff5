// The exam of docs/fitting.md: how often the recommended 95 % intervals hold the truth. Round 0 has
// its own seeds, which no development has seen.

#include "tests/calibration/coverage.hpp"

#include <gtest/gtest.h>

namespace repose::calibration::exam {
namespace {

class Coverage : public testing::TestWithParam<Kind> {};

TEST_P(Coverage, OfTheRecommendedIntervalsIs93To97Percent) {
  constexpr int twins = 500;
  const Result r = hold(GetParam(), twins, 0);
  for (std::size_t i = 0; i < 5; ++i) {
    std::printf("[ measured ] %-6s %5.1f %%, %.2f times as wide as white noise gives\n",
                std::string(parameter_names[i]).c_str(), 100.0 * r.share[i], r.width[i]);
    // binomial: √(0.95·0.05/500) = 1 %, three of them
    EXPECT_GE(r.share[i], 0.92) << parameter_names[i];
    EXPECT_LE(r.share[i], 0.98) << parameter_names[i];
  }
  std::printf("[ measured ] all    %5.1f %%\n", 100.0 * r.pooled);
  EXPECT_GE(r.pooled, 0.93);
  EXPECT_LE(r.pooled, 0.97);
  EXPECT_EQ(r.contradictions, 0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, Coverage,
                         testing::Values(Kind::plain, Kind::declared, Kind::log, Kind::ratio,
                                         Kind::bounded, Kind::prior, Kind::channels, Kind::ar1),
                         [](const auto& p) {
                           return std::string(kind_names[static_cast<std::size_t>(p.param)]);
                         });

}  // namespace
}  // namespace repose::calibration::exam
