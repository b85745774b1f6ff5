/// \file
/// The scalar functions and the symmetric tensor that every law is written in.

#include <random>

#include <gtest/gtest.h>

#include "models/dual.hpp"
#include "models/objective.hpp"
#include "models/sym.hpp"

namespace repose {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

TEST(ExpPair, BothToTwoUnitsForEveryMagnitude) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-18.0, 2.84), sign(-1.0, 1.0);
  for (int sample = 0; sample < 200000; ++sample) {
    const double x = std::copysign(std::pow(10.0, exponent(random)), sign(random));
    if (x > 708.0 || x < -707.0) continue;
    const ExpPair<double> pair = exp_pair(x);
    const auto whole = static_cast<double>(std::exp(static_cast<long double>(x)));
    const auto minus_one = static_cast<double>(std::expm1(static_cast<long double>(x)));
    EXPECT_NEAR(pair.whole, whole, 2.0 * epsilon * whole) << x;
    EXPECT_NEAR(pair.minus_one, minus_one, 2.0 * epsilon * std::abs(minus_one)) << x;
    const double over = minus_one / x;
    EXPECT_NEAR(expm1_over(x), over, 4.0 * epsilon * over) << x;
    // a lane of a Pack may fuse its multiplications differently: one rounding
    const ExpPair<Pack> wide = exp_pair(Pack(x));
    EXPECT_NEAR(wide.whole.get(0), pair.whole, 2.0 * epsilon * whole) << x;
    EXPECT_NEAR(wide.minus_one.get(Pack::size - 1), pair.minus_one,
                2.0 * epsilon * std::abs(minus_one))
        << x;
  }
}

TEST(ExpPair, EndsOfTheNumbers) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double x : {709.5, 1e300, infinity}) {
    EXPECT_EQ(exp_pair(x).whole, infinity);
    EXPECT_EQ(exp_pair(x).minus_one, infinity);
  }
  for (const double x : {-708.5, -1e300, -infinity}) {
    EXPECT_EQ(exp_pair(x).whole, 0.0);
    EXPECT_EQ(exp_pair(x).minus_one, -1.0);
  }
  EXPECT_TRUE(std::isnan(exp_pair(std::nan("")).whole));
  EXPECT_TRUE(std::isnan(exp_pair(std::nan("")).minus_one));
  EXPECT_EQ(exp_pair(0.0).whole, 1.0);
  EXPECT_EQ(exp_pair(0.0).minus_one, 0.0);
  EXPECT_EQ(expm1_over(0.0), 1.0);
  EXPECT_EQ(expm1_over(5e-324), 1.0);
}

TEST(Ln, ToTwoUnitsForEveryMagnitude) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> exponent(-323.0, 308.2), near(0.5, 2.0);
  for (int sample = 0; sample < 200000; ++sample) {
    // half of them where ln x is small against x
    const double x = sample % 2 == 0 ? std::pow(10.0, exponent(random)) : near(random);
    const auto exact = static_cast<double>(std::log(static_cast<long double>(x)));
    EXPECT_NEAR(ln(Pack(x)).get(Pack::size - 1), exact, 2.0 * epsilon * std::abs(exact)) << x;
    EXPECT_EQ(ln(x), std::log(x));
  }
  for (const double x : {1.0 - epsilon / 2, 1.0 + epsilon})
    EXPECT_NEAR(ln(Pack(x)).get(0), std::log(x), epsilon * std::abs(std::log(x)));
}

TEST(Ln, EndsOfTheNumbers) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(ln(Pack(1.0)).get(0), 0.0);
  EXPECT_EQ(ln(Pack(0.0)).get(0), -infinity);
  EXPECT_EQ(ln(Pack(-0.0)).get(0), -infinity);
  EXPECT_EQ(ln(Pack(infinity)).get(0), infinity);
  for (const double x : {-1.0, -5e-324, -infinity, std::nan("")})
    EXPECT_TRUE(std::isnan(ln(Pack(x)).get(0))) << x;
}

TEST(Masks, NegatedIsNot) {
  const Pack x(1.0), y(2.0);
  EXPECT_FALSE(any(negated(x < y)));
  EXPECT_TRUE(any(negated(x > y)));
  EXPECT_TRUE(any(negated(x < Pack(std::nan("")))));
  EXPECT_FALSE(negated(true));
  EXPECT_TRUE(any(!(Twin(1.0) > Twin(2.0))));
  EXPECT_FALSE(any(!(Twin(1.0) < Twin(2.0))));
}

TEST(ExpPair, DerivativesOfADual) {
  using D = Dual<1>;
  for (const double x : {-30.0, -1.0, -0.021, -0.019, -1e-9, 0.0, 1e-9, 0.019, 0.021, 1.0, 30.0}) {
    const ExpPair<D> pair = exp_pair(D(x, 0));
    EXPECT_NEAR(pair.whole.v[0], std::exp(x), 2.0 * epsilon * std::exp(x));
    EXPECT_NEAR(pair.minus_one.v[0], std::exp(x), 2.0 * epsilon * std::exp(x));
    // d/dx (e^x − 1)/x = (e^x(x − 1) + 1)/x² = Σ x^k/(k! (k+2)), in long double by the series
    long double series = 0.0L, term = 1.0L;
    for (int k = 0; k < 200; ++k) {
      series += term / (k + 2);
      term *= static_cast<long double>(x) / (k + 1);
    }
    const D over = expm1_over(D(x, 0));
    // the quotient rule cancels ε/x of it, and the series for x = −30 e^30 of itself
    const double tolerance = 1e-13;
    const double expected =
        x < -10.0 ? (std::exp(x) * (x - 1.0) + 1.0) / (x * x) : static_cast<double>(series);
    EXPECT_NEAR(over.v[0], expected, tolerance * expected) << x;
    EXPECT_EQ(over.a, expm1_over(D(x)).a);
  }
}

TEST(Select, FloorKeepsNaN) {
  EXPECT_EQ(floor_at(-1.0, 0.0), 0.0);
  EXPECT_EQ(floor_at(2.0, 0.0), 2.0);
  EXPECT_TRUE(std::isnan(floor_at(std::nan(""), 0.0)));
  const Pack wide = floor_at(Pack(std::nan("")), 0.0);
  EXPECT_TRUE(std::isnan(wide.get(0)));
  EXPECT_FALSE(finite(std::nan("")));
  EXPECT_FALSE(any(finite(Pack(std::numeric_limits<double>::infinity()))));
  EXPECT_TRUE(any(finite(Pack(1.0))));
}

TEST(SymTensor, MeanOfEqualComponentsIsExact) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int sample = 0; sample < 10000; ++sample) {
    const double x = uniform(random) * 1e5;
    const auto a = Sym<double, 6>::isotropic(x);
    EXPECT_EQ(mean(a), x);
    EXPECT_EQ(pressure(a), -x);
    EXPECT_EQ(mises(a), 0.0);
    for (int k = 0; k < 6; ++k) EXPECT_EQ(deviator(a)[k], 0.0);
  }
}

TEST(SymTensor, Invariants) {
  Sym<double, 6> a;
  a.c = {-3.0, -1.0, -2.0, 0.5, -0.25, 0.75};
  EXPECT_EQ(trace(a), -6.0);
  EXPECT_EQ(pressure(a), 2.0);
  // s = (−1, 1, 0), s:s = 2 + 2(0.25 + 0.0625 + 0.5625) = 3.75; τ = √(s:s/2), q = √(3/2 s:s)
  EXPECT_EQ(contract(deviator(a), deviator(a)), 3.75);
  EXPECT_EQ(shear_norm(deviator(a)), std::sqrt(1.875));
  EXPECT_NEAR(mises(a), std::sqrt(5.625), 4.0 * epsilon);
  // triaxial: q = σ_a − σ_r
  Sym<double, 6> triaxial;
  triaxial.c = {-300.0, -100.0, -100.0, 0.0, 0.0, 0.0};
  EXPECT_NEAR(mises(triaxial), 200.0, 4.0 * epsilon * 200.0);
  // no derivative exists at s = 0: the one-sided 0 instead of NaN
  Sym<Dual<1>, 4> none = Sym<Dual<1>, 4>::isotropic(Dual<1>(1.0, 0));
  EXPECT_EQ(shear_norm(deviator(none)).v[0], 0.0);
}

TEST(Rotation, QuarterTurnAndVectorComponents) {
  Sym<double, 6> a;
  a.c = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  // Cayley turns by 2 atan(θ/2): θ = 2 is a quarter turn, x → y, y → −x
  const Sym<double, 6> r = rotated_in_plane(a, 2.0);
  const std::array<double, 6> expected{2.0, 1.0, 3.0, -4.0, 6.0, -5.0};
  for (int k = 0; k < 6; ++k)
    EXPECT_NEAR(r[k], expected[static_cast<std::size_t>(k)], 8.0 * epsilon);
  EXPECT_EQ(rotated_in_plane(a, 0.0).c, a.c);
}

}  // namespace
}  // namespace repose
