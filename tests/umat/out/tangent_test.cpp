/// \file
/// DDSDDE against central differences of the UMAT itself.

#include "tests/models/central_difference.hpp"
#include "tests/umat/out/call_umat.hpp"

namespace repose::umat {
namespace {

template <class L>
class UmatTangent : public ::testing::Test {};
TYPED_TEST_SUITE(UmatTangent, LawTypes, LawName);

template <class L>
void check(const LawExample& example, int nshr, Comparison& compare) {
  const auto P = parameters_of<L>(example);
  Random random(21);
  const bool plane = nshr == 1;
  for (int sample = 0; sample < 60; ++sample) {
    const LawPoint<L> start = random_point<L>(example, P, random, plane);
    const Sym<double, 6> strain = random.tensor(example.strain * random.decade(-2.0, 0.0), plane);
    const Host before = host_of<L>(example, start, nshr);
    const std::vector<double> dstran = host_strain(strain, before.components());
    Host end = before;
    ASSERT_TRUE(end.step(dstran, example.time));
    const auto stepped = [&](std::size_t j, double h) {
      Host host = before;
      std::vector<double> e = dstran;
      e[j] += h;
      EXPECT_TRUE(host.step(e, example.time));
      return host.stress;
    };
    LawPoint<L> after = start;
    ASSERT_FALSE(after.step(P, strain, example.time));
    // as of the law's own tangent: Cam-Clay's root is known to about 20 ε of w, y = Lw to that
    // times |L| < 5
    const double units = L::state.size() > 0 ? 100.0 : 8.0;
    const double noise = units * epsilon * stress_scale(P, start, after, strain);
    // small against the curvature (strains of example.strain), large against round-off
    const double h = 2e-5 * example.strain;
    const double size = 10.0 * largest(after.stress) / example.strain;
    for (std::size_t j = 0; j < before.components(); ++j) {
      const auto plus = stepped(j, h), minus = stepped(j, -h);
      const auto half_plus = stepped(j, 0.5 * h), half_minus = stepped(j, -0.5 * h);
      for (std::size_t i = 0; i < before.components(); ++i)
        compare(end.ddsdde[i + j * before.components()], plus[i], minus[i], half_plus[i],
                half_minus[i], h, noise, size,
                example.label + ": DDSDDE(" + std::to_string(i + 1) + ", " + std::to_string(j + 1) +
                    "), NSHR = " + std::to_string(nshr));
    }
  }
}

TYPED_TEST(UmatTangent, IsThatOfTheUmat) {
  for (const LawExample& example : examples_of<TypeParam>()) {
    Comparison compare;
    check<TypeParam>(example, 3, compare);
    check<TypeParam>(example, 1, compare);
    EXPECT_GT(compare.sharp, compare.all / 2) << example.label;
  }
}

/// A host may ask before it has a strain: the answer is that of unloading, a stiffness.
TYPED_TEST(UmatTangent, WithoutAStrainIsThatOfUnloading) {
  using L = TypeParam;
  for (const LawExample& example : examples_of<L>()) {
    const auto P = parameters_of<L>(example);
    Random random(22);
    const LawPoint<L> start = random_point<L>(example, P, random, false);
    const auto of = [&](double extension) {
      Host host = host_of<L>(example, start, 3);
      EXPECT_TRUE(host.step({extension, extension, extension, 0.0, 0.0, 0.0}, example.time));
      return host.ddsdde;
    };
    const auto none = of(0.0), little = of(1e-12);
    double size = 0.0;
    for (const double x : little) size = std::max(size, std::abs(x));
    ASSERT_GT(size, 0.0);
    // moduli change by no more than 1/κ* < 2000 of themselves per strain
    for (std::size_t k = 0; k < none.size(); ++k)
      EXPECT_NEAR(none[k], little[k], 2e-8 * size) << example.label << ", entry " << k;
  }
}

}  // namespace
}  // namespace repose::umat
