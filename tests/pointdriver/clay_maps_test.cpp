/// \file
/// Maps of Cam-Clay's update: the exact one always has a result, the linearised one not beyond κ.

#include "pointdriver/study/clay_maps.hpp"

#include <gtest/gtest.h>

namespace repose::point {
namespace {

LawSpec column() {
  return {"modified_cam_clay",
          {{"compression", "ln_v-ln_p"}},
          {{"M", 0.6614},
           {"lambda", 0.0186},
           {"kappa", 0.001},
           {"nu", 0.3},
           {"Gamma", 1.0 / 0.648},
           {"p_ref", 1.0},
           {"rho_p", 2000.0}}};
}

TEST(ClayMaps, ExactAlwaysConvergesLinearisedNotBeyondKappa) {
  const LawSpec spec = column();
  const auto theta = checked_parameters(spec);
  const std::array<ClayStart, 2> starts{{{1e3, 4.0}, {1e3, 50.0}}};
  std::vector<ClayStep> steps;
  for (const double v : {-3.0, -0.5, 0.5, 1.5, 3.0})
    for (const double q : {0.0, 2.0}) steps.push_back({1e-3 * v, 1e-3 * q});
  int lost = 0;
  for (const ClayCell& cell : clay_step_map(find_law(spec), theta, starts, steps)) {
    if (cell.update == ClayUpdate::exact) {
      EXPECT_TRUE(cell.outcome.converged);
      EXPECT_LT(cell.outcome.evaluations, 60);  // bisection alone would need 52
    } else if (!cell.outcome.converged) {
      ++lost;
    } else if (cell.step.eps_v > 1e-3) {
      EXPECT_GT(cell.outcome.error, 0.1) << "a result beyond the singularity is no solution";
    }
  }
  EXPECT_GT(lost, 0);
}

TEST(ClayMaps, PathsConvergeAtFirstOrder) {
  const LawSpec spec = column();
  const auto theta = checked_parameters(spec);
  const std::array<ClayStep, 1> path{{{0.0, 0.02}}};
  const auto error = [&](int steps, ClayUpdate update) {
    return drive_clay(find_law(spec), theta, {1e3, 1.5}, path, steps, update).error;
  };
  // backward Euler: an error proportional to the step, 1.7 to 2.3 for twice the steps
  for (const ClayUpdate update : {ClayUpdate::exact, ClayUpdate::linearised}) {
    const double ratio = error(200, update) / error(400, update);
    EXPECT_GT(ratio, 1.7);
    EXPECT_LT(ratio, 2.3);
  }
}

TEST(ClayMaps, NeedCamClay) {
  const LawSpec water{"newtonian", {}, {{"eta", 1.0}, {"K", 1e5}, {"rho_0", 1e3}}};
  const std::array<ClayStep, 1> path{{{0.0, 0.02}}};
  EXPECT_THROW(drive_clay(find_law(water), checked_parameters(water), {1e3, 1.0}, path, 1,
                          ClayUpdate::exact),
               InputError);
}

}  // namespace
}  // namespace repose::point
