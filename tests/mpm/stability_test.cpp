/// \file
/// Measured stability limits against theory, and failures of the method in the problems that show
/// them.

#include <gtest/gtest.h>

#include "models/law_material.hpp"
#include "models/linearised_cam_clay.hpp"
#include "mpm/output/history.hpp"
#include "mpm/study/blow_up.hpp"
#include "mpm/study/failure_modes.hpp"
#include "mpm/study/ill_posed_points.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

// An isolated point strains itself (step_size.hpp): the theory is exact for small strains, the
// bisection ends within 1 %, and 600 steps tell growth from 1 % above the limit.
TEST(BlowUp, IsolatedPoint) {
  for (const Kernel kernel : {Kernel::cubic, Kernel::quadratic})
    for (const bool solid : {false, true}) {
      const StepTrial trial{kernel, Transfer::apic, 1, Place::isolated, 0.3, solid};
      const double theory = courant_of_theory(trial);
      EXPECT_NEAR(blow_up_courant(trial), theory, 0.03 * theory) << name_of(kernel) << solid;
    }
}

TEST(BlowUp, DefaultCourantNumberIsStable) {
  // 0.8, the default, below every measured limit of the default kernel and transfer
  for (const Place place : {Place::bulk, Place::surface, Place::isolated})
    EXPECT_GT(blow_up_courant({Kernel::cubic, Transfer::relaxed, 4, place, 0.5, false}), 0.8)
        << place_names[static_cast<std::size_t>(place)];
}

TEST(FailureModes, CellCrossingAndFracture) {
  // measured 0.0012; splines with jumps in their gradient (linear) would be off by the order of one
  const Discretisation d{Kernel::cubic, Transfer::apic, 4, 6.0};
  EXPECT_LT(cell_crossing_error(d), 0.01);
  // points a cell apart lose each other before points half a cell apart
  Discretisation sparse = d;
  sparse.points_per_cell = 1;
  EXPECT_LT(fracture_stretch(sparse), fracture_stretch(d));
}

TEST(IllPosedPoints, SharesOfAShearedStrip) {
  Scene scene = empty_box(0.1, 0.1, 0.0125);
  scene.bodies = {block(0.0, 0.0, 0.1, 0.1, mu_i())};
  scene.bodies[0].initial.p = 1e3;
  Simulation::Snapshot points = Simulation(scene, 1).snapshot();
  // at rest nothing flows; sheared at I = 0.01 (ill-posed) in one half, at I = 0.1 in the other
  EXPECT_EQ(ill_posed_share(points, ill_posedness(scene, points)).flowing, 0.0);
  for (std::size_t i = 0; i < points.x_m.size(); ++i) {
    const double I = points.x_m[i] < 0.05 ? 0.01 : 0.1;
    points.shear_rate[i] = I / (0.0053 * std::sqrt(2000.0 / points.pressure_Pa[i]));
    const double mu = 0.3819 + (0.5718 - 0.3819) * I / (0.279 + I);
    points.mises_Pa[i] = std::sqrt(3.0) * mu * points.pressure_Pa[i];
  }
  const IllPosedShare share = ill_posed_share(points, ill_posedness(scene, points));
  EXPECT_NEAR(share.flowing, 1.0, 1e-12);
  EXPECT_NEAR(share.ill_posed, 0.5, 1e-12);
}

TEST(History, ALawOfTheProgramsOwn) {
  // the linearised contrast loses points for good at a step that the law itself carries
  Scene scene = column_collapse(cam_clay(), 0.05);
  raise_top_to_cells(scene);
  scene.end_time = 0.2;
  scene.dt = 2e-4;
  Prescribed prescribed;
  prescribed.material =
      std::make_shared<LawMaterial<LinearisedCamClay>>(checked_parameters(scene.bodies[0].law));
  const History lost = record(scene, prescribed, 4);
  EXPECT_EQ(lost.failure, "");
  EXPECT_GT(lost.rows.back().points_separated, 0);
  for (std::size_t k = 1; k < lost.rows.size(); ++k)
    EXPECT_GE(lost.rows[k].points_separated, lost.rows[k - 1].points_separated);
  EXPECT_EQ(record(scene, {}, 4).rows.back().points_separated, 0);
}

}  // namespace
}  // namespace repose::mpm
