// The neo-Hookean solid against its closed form (physics.md, NH).

#include "models/neo_hookean.hpp"

#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

// One step of principal strains from rest: b = diag(e^{2ε_i}), J = e^{Σε}, and
// σ_i = (λ ln J + μ(e^{2ε_i} − 1))/J, exactly, however long the step.
TEST(NeoHookean, OneLongStepIsTheClosedForm) {
  const std::array<double, 3> theta{1e6, 0.3, 1000.0};
  const auto P = NeoHookean::Params<double>::from(theta);
  for (const double size : {1e-3, 0.1, 0.6}) {
    Sym<double, 6> strain{};
    strain.c = {size, -0.5 * size, 0.2 * size, 0.0, 0.0, 0.0};
    LawPoint<NeoHookean> point{Sym<double, 6>::isotropic(0.0), {}, theta[2]};
    ASSERT_FALSE(point.step(P, strain, 1.0));
    const double ln_J = trace(strain), J = std::exp(ln_J);
    for (std::size_t i = 0; i < 3; ++i) {
      const double exact = (P.lambda() * ln_J + P.mu() * std::expm1(2.0 * strain.c[i])) / J;
      // a dozen roundings of terms of the size of λ + 2μ times the strain
      EXPECT_NEAR(point.stress.c[i], exact, 12.0 * epsilon * (P.lambda() + 2.0 * P.mu()) * size)
          << size << " " << i;
    }
  }
}

}  // namespace
}  // namespace repose
