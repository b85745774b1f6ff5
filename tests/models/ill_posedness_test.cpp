/// \file
/// Where incompressible flow is ill-posed, against the published limits and against the dispersion
/// relation worked out direction by direction.

#include "models/ill_posedness.hpp"

#include "models/shear_response.hpp"
#include "tests/models/law_samples.hpp"

namespace repose {
namespace {

std::vector<double> column(const char* form) {
  const LawExample example = examples_of(find_law({"mu_i", {{"form", form}}, {}})).front();
  return checked_parameters(example.spec);
}

/// γ̇ at which the inertial number of the column's grains is I under 1 kPa.
double rate_of(double I) { return I / (0.0053 * std::sqrt(2000.0 / 1e3)); }

double C_of(double I) {
  return ill_posedness(
      shear_response<MuIElastoviscoplastic>(column("elastoviscoplastic"), 1e3, rate_of(I)));
}

TEST(IllPosedness, OutsideTheIntervalOfThePaper) {
  const auto root = [&](double low, double high) {
    const bool falls = C_of(low) > 0.0;
    EXPECT_NE(falls, C_of(high) > 0.0);
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      ((C_of(middle) > 0.0) == falls ? low : high) = middle;
    }
    return low;
  };
  // the two digits that are quoted, (0.028, 0.82)                                             MUI-6
  EXPECT_NEAR(root(1e-4, 0.1), 0.028, 5e-4);
  EXPECT_NEAR(root(0.1, 10.0), 0.82, 5e-3);
  EXPECT_NEAR(lower_neutral_inertial_number(0.3819, 0.5718, 0.279), root(1e-4, 0.1), 1e-12);
  EXPECT_TRUE(std::isnan(lower_neutral_inertial_number(0.4, 0.4, 0.3)));  // χ = 0: nowhere
}

TEST(IllPosedness, ClosedFormOfMuI) {
  // C = 4(χ² − χ) + μ²(1 − χ/2)² with μ′ by hand; round-off of a sum of terms below 2
  for (const double I : {1e-3, 0.05, 0.3, 2.0}) {
    const double mu = 0.3819 + (0.5718 - 0.3819) * I / (0.279 + I);
    const double chi = I * (0.5718 - 0.3819) * 0.279 / ((0.279 + I) * (0.279 + I)) / mu;
    const double C = 4.0 * (chi * chi - chi) + mu * mu * (1.0 - 0.5 * chi) * (1.0 - 0.5 * chi);
    EXPECT_NEAR(C_of(I), C, 64.0 * epsilon) << I;
  }
}

TEST(IllPosedness, FastestDirectionAndItsSign) {
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    const ShearResponse response{1.0, random(0.0, 0.5), random(0.0, 0.95)};
    const double beta = fastest_direction(response);
    const double most = growth_of_direction(response, beta);
    // no direction of a fine scan grows faster, and g > 0 is C > 0
    for (double other = -1.0; other <= 1.0; other += 0.01)
      EXPECT_LE(growth_of_direction(response, other), most + 8.0 * epsilon);
    if (std::abs(most) > 1e-12) {
      EXPECT_EQ(most > 0.0, ill_posedness(response) > 0.0);
    }
  }
}

TEST(IllPosedness, CreepOfTheRegularisedFormIsWellPosed) {
  // γ̇ ≪ r: Newtonian, χ = 1 up to (γ̇/r)²
  const auto theta = column("regularised");
  const ShearResponse creep = shear_response<MuIRegularised>(theta, 1e3, 1e-7);
  EXPECT_NEAR(creep.chi, 1.0, 1e-5);
  EXPECT_LT(growth_of_direction(creep, fastest_direction(creep)), 0.0);
  EXPECT_GT(ill_posedness(shear_response<MuIRegularised>(theta, 1e3, 1e-2)), 0.0);
}

TEST(IllPosedness, BarkerGrayIsWellPosedFromRest) {
  const std::vector<double> theta = column("barker_gray");
  const auto at = [&](double I) {
    const auto response = shear_response<MuIBarkerGray>(theta, 1e3, rate_of(I));
    return growth_of_direction(response, fastest_direction(response));
  };
  // r = 1e-4 1/s is I = 7e-7; from there to the upper limit, which μ_∞ moves to I > 10
  for (double I = 1e-6; I < 10.0; I *= 1.1) EXPECT_LT(at(I), 0.0) << I;
  // μ is continuous at I_1 (three decimals of the jump that 1e-6 away the slope makes)
  const auto P = MuIBarkerGray::Params<double>::from(std::span<const double>(theta));
  EXPECT_NEAR(MuIBarkerGray::friction(P, P.I_1 * (1 - 1e-6)),
              MuIBarkerGray::friction(P, P.I_1 * (1 + 1e-6)), 1e-6);
  EXPECT_NEAR(P.I_1, 0.028, 5e-4);
}

TEST(IllPosedness, OfAMaterial) {
  const auto material = make_material(examples_of(find_law({"mu_i", {}, {}})).front().spec);
  EXPECT_NEAR(ill_posedness(*shear_response(*material, 1e3, rate_of(0.3))), C_of(0.3), 0.0);
  EXPECT_FALSE(shear_response(*material, 0.0, 1.0));
  EXPECT_FALSE(shear_response(*material, 1e3, 0.0));
  const auto clay = make_material(
      examples_of(find_law({"modified_cam_clay", {{"compression", "v-ln_p"}}, {}})).front().spec);
  EXPECT_FALSE(shear_response(*clay, 1e3, 1.0));
}

}  // namespace
}  // namespace repose
