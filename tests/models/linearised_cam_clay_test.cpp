/// \file
/// The linearised contrast: the same law for small steps, lost where one step's volume strain
/// reaches κ.

#include "models/linearised_cam_clay.hpp"

#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

using Exact = LinearisedCamClay::Exact;

LawExample column() { return examples_of(LawMaterial<Exact>::info()).front(); }

template <class L>
LawPoint<L> compressed(double volume_strain, int steps) {
  const auto P = parameters_of<L>(column());
  InitialConditions given;
  given.p = 1e3;
  given.ocr = 1.0;
  const InitialPoint start = L::initial(P, given);
  LawPoint<L> point{start.stress, {start.state[0], start.state[1]}, start.density};
  Sym<double, 4> strain;
  for (int k = 0; k < 3; ++k) strain[k] = -volume_strain / (3.0 * steps);
  strain[3] = 0.5 * volume_strain / steps;
  for (int k = 0; k < steps; ++k) EXPECT_FALSE((point.template step<4>(P, strain, 1e-4)));
  return point;
}

TEST(LinearisedCamClay, IsTheSameLawForSmallSteps) {
  // both are first order in the step: ten times more steps, ten times less between them (8 to 12)
  const auto distance = [](int steps) {
    const auto a = compressed<LinearisedCamClay>(2e-3, steps);
    const auto b = compressed<Exact>(2e-3, steps);
    return std::abs(pressure(a.stress) - pressure(b.stress)) / pressure(b.stress);
  };
  const double coarse = distance(200), fine = distance(2000);
  EXPECT_LT(fine, 1e-3);
  EXPECT_GT(coarse / fine, 8.0);
  EXPECT_LT(coarse / fine, 12.0);
}

TEST(LinearisedCamClay, LosesWhatTheExactUpdateCarries) {
  // elastic (OCR 50): p grows tenfold at 0.9 κ; beyond κ the linearised pressure is negative
  const auto P = parameters_of<LinearisedCamClay>(column());
  InitialConditions given;
  given.p = 1e3;
  given.ocr = 50.0;
  for (const double in_kappa : {-3.0, 0.9, 1.1}) {
    const InitialPoint start = LinearisedCamClay::initial(P, given);
    LawPoint<LinearisedCamClay> point{start.stress, {start.state[0], 0.0}, start.density};
    Sym<double, 4> strain;
    for (int k = 0; k < 3; ++k) strain[k] = -in_kappa * P.kappa / 3.0;
    EXPECT_FALSE((point.step<4>(P, strain, 1e-4)));
    const bool lost = LinearisedCamClay::lost(point.state);
    EXPECT_EQ(lost, in_kappa > 1.0) << in_kappa;
    // p = p_n/(1 − Δε_v/κ), to the round-off of the quotient
    if (!lost)
      EXPECT_NEAR(pressure(point.stress), 1e3 / (1.0 - in_kappa), 1e-12 * 1e3 / (1.0 - in_kappa));
    else
      EXPECT_EQ(largest(point.stress), 0.0);
  }
}

}  // namespace
}  // namespace repose
