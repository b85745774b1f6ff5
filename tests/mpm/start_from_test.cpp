/// A scene that starts from the points of another run.

#include <gtest/gtest.h>

#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

struct Way {
  Transfer transfer;
  LawSpec law;
  Storage storage = Storage::double_precision;
  bool space = false;
};

Scene column(const Way& way) {
  Scene scene = column_collapse(way.law, 0.025);
  scene.domain[1] = 0.575;
  scene.transfer = way.transfer;
  scene.storage = way.storage;
  if (way.space) {
    scene.domain[2] = 0.1;
    scene.points_per_cell = 8;
    scene.bodies[0].size[2] = 0.1;
    scene.courant = 0.3;
  }
  scene.bodies[0].name = "column";
  return scene;
}

std::string message(const Scene& scene) {
  try {
    const Simulation simulation(scene, 1);
  } catch (const InputError& e) {
    return e.key() + ": " + e.what();
  }
  return "";
}

// The affine velocity, stress, state and density of a point are all that a step needs: cut in two,
// the run is the same but for the order in which sums are taken, since points are sorted at other
// moments. Round-off of 1e-16 grows in a collapse, by less than 1e4 in these 200 steps.
TEST(StartFrom, ARunInTwoPartsIsTheWhole) {
  for (const Way& way : {Way{Transfer::apic, mu_i()}, Way{Transfer::relaxed, mu_i()},
                         Way{Transfer::apic, cam_clay()}, Way{Transfer::apic, critical_state()},
                         Way{Transfer::apic, mu_i(), Storage::single_precision},
                         Way{Transfer::apic, mu_i(), Storage::double_precision, true}}) {
    Scene scene = column(way);
    scene.dt = 5e-5;
    Simulation whole(scene, 1), first(scene, 1);
    run_until(whole, 0.005);
    run_until(first, 0.005);
    const ScratchFolder folder;
    first.save_final_state(folder.path() / "final_state.h5");
    scene.start_from = folder.path().string();
    Simulation second(scene, 1);
    EXPECT_EQ(second.time(), 0.0);
    EXPECT_EQ(second.point_count(), whole.point_count());
    run_until(whole, 0.01);
    run_until(second, 0.005);
    const auto a = whole.point_fields(), b = second.point_fields();
    const double digits = way.storage == Storage::single_precision ? 1e-5 : 1e-11;
    for (std::size_t k = 0; k < a.position.size(); ++k) {
      ASSERT_NEAR(a.position[k], b.position[k], digits * 0.4);
      ASSERT_NEAR(a.velocity[k], b.velocity[k], 1e3 * digits) << k;
    }
    for (std::size_t k = 0; k < a.density.size(); ++k)
      ASSERT_NEAR(a.density[k], b.density[k], 1e2 * digits * a.density[k]);
    const SeriesRow row = second.diagnostics();
    EXPECT_LT(std::abs(row.energy_residual_J_per_m), 1e-3 * row.potential_J_per_m);
  }
}

// What is asked for anew may differ: cells, gravity, edges, storage.
TEST(StartFrom, TakesAnotherGridAndGravity) {
  Scene scene = column({Transfer::apic, mu_i()});
  Simulation first(scene, 1);
  run_until(first, 0.02);
  const ScratchFolder folder;
  first.save_final_state(folder.path() / "final_state.h5");
  scene.start_from = folder.path().string();
  scene.domain[1] = 0.5625;
  scene.h = 0.0375;  // the box is 32 by 15 of these; no whole number of the body's spacings
  scene.gravity = 5.0;
  scene.transfer = Transfer::relaxed;
  scene.storage = Storage::single_precision;
  Simulation second(scene, 1);
  const auto a = first.point_fields(), b = second.point_fields();
  ASSERT_EQ(a.id, b.id);
  for (std::size_t k = 0; k < a.position.size(); ++k)
    ASSERT_NEAR(a.position[k], b.position[k], 1e-12);
  for (std::size_t k = 0; k < a.stress.size(); ++k)
    ASSERT_NEAR(a.stress[k], b.stress[k], 1e-7 * std::abs(a.stress[k]));  // 24 bits
  run_until(second, 0.02);
  EXPECT_EQ(second.point_count(), first.point_count());
}

TEST(StartFrom, SaysWhatDoesNotMatch) {
  Scene scene = column({Transfer::apic, mu_i()});
  const Simulation first(scene, 1);
  const ScratchFolder folder;
  scene.start_from = folder.path().string();
  EXPECT_NE(message(scene).find("output.final_state = true"), std::string::npos) << message(scene);
  first.save_final_state(folder.path() / "final_state.h5");
  EXPECT_EQ(message(scene), "");
  Scene other = scene;
  other.bodies[0].name = "heap";
  EXPECT_NE(message(other).find("no body \"heap\""), std::string::npos) << message(other);
  other = scene;
  other.bodies[0].law = cam_clay();
  EXPECT_NE(message(other).find("it has \"column\" of mu_i"), std::string::npos) << message(other);
  other = scene;
  other.bodies.push_back(other.bodies[0]);
  EXPECT_NE(message(other).find("it has 1 bodies, this scene has 2"), std::string::npos);
  other = scene;
  other.domain = {0.15, 0.575};
  EXPECT_NE(message(other).find("domain.size: the box does not hold"), std::string::npos)
      << message(other);
  other = scene;
  Surface rock;
  rock.solid.shape = Ball{{0.1, 0.1, 0.0}, 0.05};
  other.surfaces = {rock};
  EXPECT_NE(message(other).find("surface[0]: what the scene starts from is in its way"),
            std::string::npos)
      << message(other);
  other = scene;
  other.start_from = (folder.path() / "nowhere").string();
  EXPECT_NE(message(other).find("there is no such result folder"), std::string::npos);
  other = scene;
  other.equilibrium = true;
  EXPECT_NE(message(other).find("scene.start:"), std::string::npos);
}

}  // namespace
}  // namespace repose::mpm
