// mu(I) from a flow curve with 1 % noise, declared as such: how often the 95 % intervals hold the
// truth over 40 draws.

#include <gtest/gtest.h>

#include "calibration/uncertainty.hpp"
#include "study/fit/twin.hpp"

namespace repose::calibration {
namespace {

TEST(FlowCurve, IntervalsHoldTheTruthOver40DrawsOfOnePercentNoise) {
  const LawSpec spec{"mu_i",
                     {{"form", "elastoviscoplastic"}},
                     {{"mu_0", 0.3819},
                      {"mu_d", 0.6436},
                      {"I_0", 0.279},
                      {"d", 5.3e-4},
                      {"rho_p", 2500.0},
                      {"rho_0", 1500.0},
                      {"K", 5e6}}};
  study::Twin twin;
  twin.law = &find_law(spec);
  twin.theta = checked_parameters(spec);
  twin.make_free("mu_0", 0.1, 0.42);
  twin.make_free("mu_d", 0.45, 1.5);
  twin.make_free("I_0", 0.01, 3.0, Scale::log);
  study::TwinTest test;
  test.name = "flow curve";
  std::vector<double> rates;
  for (int i = 0; i < 24; ++i) {
    test.abscissae.push_back(1e-3 * std::pow(10.0, i / 23.0 * 4.0));
    rates.push_back(test.abscissae.back() * std::sqrt(5e3 / 2500.0) / 5.3e-4);  // MUI-2
  }
  test.path = flow_curve_path(rates, point::Condition::constant_volume, 0.5);
  test.rows = Rows::leg_ends;
  test.initial.p = 5e3;
  test.x = point::Quantity::I;
  test.y = {point::Quantity::mu};
  const Target clean = study::measure(twin, test);
  constexpr int draws = 40;
  std::array<int, 3> hits{};
  for (int k = 0; k < draws; ++k) {
    Target noisy = clean;
    std::mt19937_64 random(static_cast<std::uint64_t>(k + 1));
    std::normal_distribution<double> normal;
    for (double& mu : noisy.channels[0].observed) mu *= 1.0 + 0.01 * normal(random);
    declare_noise(noisy.channels[0], 0.0, 0.01);
    const Problem problem(ParameterSpace(twin.free), {noisy});
    const Optimum o =
        levenberg_marquardt(problem, problem.space().coordinates(twin.truth_vector()));
    const Uncertainty u = uncertainty(problem, o.z);
    for (std::size_t i = 0; i < 3; ++i)
      if (u.interval[i][0] <= twin.truth[i] && twin.truth[i] <= u.interval[i][1]) ++hits[i];
  }
  // of 40 draws at 95 %, fewer than 33 come with P < 0.2 % (binomial)
  for (std::size_t i = 0; i < 3; ++i) {
    std::printf("[ measured ] %s: %d of %d\n", twin.free[i].name.c_str(), hits[i], draws);
    EXPECT_GE(hits[i], 33) << twin.free[i].name;
  }
  const Problem exact(ParameterSpace(twin.free), {clean});
  EXPECT_LT(study::worst_error(
                twin, exact.space().values(levenberg_marquardt(exact, exact.space().start()).z)),
            1e-6);
}

TEST(FlowCurve, ANoiseInSharesOfZeroNeedsAnAbsolutePart) {
  Channel channel;
  channel.name = "mu";
  channel.observed.resize(3);
  channel.observed << 0.0, 0.4, 0.3;
  EXPECT_THROW(declare_noise(channel, 0.0, 0.01), InputError);
  declare_noise(channel, 0.003, 0.01);
  EXPECT_DOUBLE_EQ(scale_of(channel, 0), 0.003);
  EXPECT_DOUBLE_EQ(scale_of(channel, 1), 0.005);  // 3-4-5
}

}  // namespace
}  // namespace repose::calibration
