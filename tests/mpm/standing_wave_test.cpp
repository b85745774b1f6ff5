/// An elastic bar that swings in its slowest mode: frequency and decay of every transfer.

#include "tests/mpm/standing_wave.hpp"

#include <gtest/gtest.h>

namespace repose::mpm {
namespace {

struct Case {
  Kernel kernel;
  Transfer transfer;
};
void PrintTo(const Case& one, std::ostream* out) { *out << name_of(one.transfer); }

class StandingWaveTest : public ::testing::TestWithParam<Case> {
 protected:
  Scene scene(int n, double C = 0.4) const {
    Scene s = wave_.scene(n, GetParam().kernel, GetParam().transfer, C);
    if (s.transfer == Transfer::relaxed) s.relaxation_time = 0.02 * wave_.period();
    s.order = 3;
    return s;
  }
  StandingWave wave_;
};

// To what the map leaves out, the square of the pattern within cells, in the frequency, and (kh)²σ²
// < (kh)²/3 of it per step in the decay, where only the affine velocity carries it. Beside that,
// 1e-6: the straight lines through zeros and parabolas through extremes, 80 or 160 steps apart.
TEST_P(StandingWaveTest, SwingsAsTheMapOfItsModeDoes) {
  for (const int n : {8, 16}) {
    const Scene s = scene(n);
    const StandingWave::Swing found = wave_.run(s, 3.2), expected = wave_.predicted(s, 3.2);
    const double left_out = std::pow(wave_.pattern(s), 2), kh = wave_.k() * s.h;
    const double steps = wave_.period() / *s.dt;
    EXPECT_NEAR(found.omega / expected.omega, 1.0, 1e-6 + left_out) << n;
    EXPECT_NEAR(found.decrement, expected.decrement, 1e-6 + steps * left_out * kh * kh / 3.0) << n;
    EXPECT_GT(expected.decrement, 0.0);
  }
}

// ω_h/ω = 1 − a(kh)² + O(kh)⁴. From Ŵ = 1 − σ²(kh)²/2 and, with the fourth moment of the spline,
// 2.7σ⁴ (cubic), S = 1 − 0.45σ²(kh)²: gradient and force cost 0.45σ² together, or σ²/2 with the
// spline's gradient. Where no affine velocity makes up for it, velocities are filtered on both
// ways, another σ²/2; FMPM gives that back and, from order 2, one power more: A = 1 + σ²(kh)² on
// each of the two velocities of a swing, 0.45 + ½ − 1. So does the leapfrog, +(ωΔt)²/24.
TEST(StandingWaveOrderTest, IsTwoWithTheConstantOfTheTransfer) {
  const StandingWave wave;
  const double sigma2 = 1.0 / 3.0, C = 0.1;
  for (const auto& [transfer, a] : {std::pair{Transfer::flip, 0.95 * sigma2},
                                    {Transfer::xpic, 0.95 * sigma2},
                                    {Transfer::apic, 0.45 * sigma2},
                                    {Transfer::aflip, 0.45 * sigma2},
                                    {Transfer::tpic, 0.5 * sigma2},
                                    {Transfer::fmpm, -0.05 * sigma2}}) {
    Scene s = wave.scene(32, Kernel::cubic, transfer, C);
    s.order = 4;
    const double kh = wave.k() * s.h;
    const double expected = -a * kh * kh + C * C * kh * kh / 24.0;
    // (kh)⁴ with constants of the order of one, and the alias at 4π/h of the gradient, 1e-3 (kh)²
    EXPECT_NEAR(wave.run(s, 2.2).omega / wave.omega() - 1.0, expected,
                std::pow(kh, 4) + 1e-3 * kh * kh)
        << name_of(transfer);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Transfers, StandingWaveTest,
    ::testing::Values(Case{Kernel::cubic, Transfer::flip}, Case{Kernel::cubic, Transfer::apic},
                      Case{Kernel::cubic, Transfer::aflip}, Case{Kernel::cubic, Transfer::relaxed},
                      Case{Kernel::cubic, Transfer::tpic}, Case{Kernel::cubic, Transfer::xpic},
                      Case{Kernel::cubic, Transfer::fmpm}, Case{Kernel::quadratic, Transfer::flip},
                      Case{Kernel::quadratic, Transfer::apic}),
    [](const auto& one) {
      return std::string(name_of(one.param.kernel)) + "_" +
             std::string(name_of(one.param.transfer));
    });

}  // namespace
}  // namespace repose::mpm
