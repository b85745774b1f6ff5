// What validate() refuses, with the key that a reader points at and the whole text.
#include "mpm/scene/scene.hpp"

#include <gtest/gtest.h>

namespace repose::mpm {
namespace {

Scene sound() {
  Scene scene;
  scene.name = "column";
  scene.end_time = 1.2;
  scene.domain = {1.2, 0.5625};
  scene.h = 0.00625;
  Body body;
  body.size = {0.2, 0.4};
  body.law = {"mu_i",
              {},
              {{"mu_0", 0.38},
               {"mu_d", 0.57},
               {"I_0", 0.28},
               {"d", 5e-3},
               {"rho_p", 2000.0},
               {"rho_0", 1300.0},
               {"K", 1e5}}};
  scene.bodies = {body};
  return scene;
}

Scene clay() {
  Scene scene = sound();
  scene.bodies[0].law = {"modified_cam_clay",
                         {{"compression", "ln_v-ln_p"}},
                         {{"M", 1.0}, {"lambda", 0.02}, {"kappa", 0.002}, {"nu", 0.3}, {"N", 2.0}}};
  scene.bodies[0].initial.p = 1e3;
  return scene;
}

std::string complaint(const Scene& scene) {
  try {
    validate(scene);
  } catch (const InputError& error) {
    return error.key() + ": " + error.what();
  }
  return "";
}

TEST(Scene, a_sound_one_passes) {
  EXPECT_EQ(complaint(sound()), "");
  EXPECT_EQ(complaint(clay()), "");
  EXPECT_EQ(point_spacing(sound()), 0.003125);
  EXPECT_EQ(point_lattice(sound(), sound().bodies[0]), (std::array<std::int64_t, 3>{64, 128, 1}));
}

TEST(Scene, numbers_out_of_range) {
  Scene scene = sound();
  scene.end_time = -1.0;
  EXPECT_EQ(complaint(scene), "scene.end_time: end_time = -1 is out of range: must be >= 0");
  scene = sound();
  scene.tilt_deg = 91.0;
  EXPECT_EQ(complaint(scene), "scene.tilt_deg: tilt_deg = 91 is out of range: must be [-90, 90]");
  scene = sound();
  scene.courant = 0.0;
  EXPECT_EQ(complaint(scene), "step.courant: courant = 0 is out of range: must be (0, 1.4]");
  scene = sound();
  scene.dt = 0.0;
  EXPECT_EQ(complaint(scene), "step.dt: dt = 0 is out of range: must be > 0");
  scene = sound();
  scene.h = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(complaint(scene), "grid.h: h = nan is out of range: must be > 0");
  scene = sound();
  scene.frame_interval = 1e-7;
  EXPECT_EQ(complaint(scene),
            "output.frame_interval: an interval of 1e-07 s would write 1.2e+07 frames; it must be "
            ">= 1.2e-06 s");
  scene = sound();
  scene.right = {Wall::Kind::friction, -0.1};
  EXPECT_EQ(complaint(scene), "domain.right: friction = -0.1 is out of range: must be >= 0");
}

TEST(Scene, cells_that_do_not_fill_the_box) {
  Scene scene = sound();
  scene.h = 0.0065;
  EXPECT_EQ(complaint(scene),
            "grid.h: h = 0.0065 m does not divide the box's width of 1.2 m (184.615 cells); h = "
            "0.00625 or 0.008 m would");
  scene = sound();
  scene.domain[1] = 0.56;
  EXPECT_EQ(complaint(scene),
            "domain.size: the box's height of 0.56 m is 89.6 cells of h = 0.00625 m; 0.55625 or "
            "0.5625 m would fit");
  EXPECT_TRUE(raise_top_to_cells(scene));
  EXPECT_EQ(scene.domain[1], 0.5625);
  EXPECT_EQ(complaint(scene), "");
  EXPECT_FALSE(raise_top_to_cells(scene));
  // within a millionth of a cell counts as whole
  scene.domain[0] = 1.2 + 0.9e-6 * scene.h;
  EXPECT_EQ(complaint(scene), "");
  scene.domain[0] = 1.2 + 1.1e-6 * scene.h;
  EXPECT_NE(complaint(scene), "");
}

TEST(Scene, bodies_that_overlap_or_only_touch) {
  Scene scene = sound();
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies[1].name = "second";
  scene.bodies[1].origin = {0.2, 0.0};
  EXPECT_EQ(complaint(scene), "");
  scene.bodies[1].origin = {0.1, 0.1};
  EXPECT_EQ(
      complaint(scene),
      "body[1].origin: body[1] \"second\" overlaps body[0] in x = [0.1, 0.2] m, y = [0.1, 0.4] "
      "m");
}

TEST(Scene, no_body_and_too_many_points) {
  Scene scene = sound();
  scene.domain = {0.25, 0.5};
  scene.h = 0.25 / 8192.0;  // 0.2 × 0.4 m × 4 points per h² make 3.44e8
  EXPECT_EQ(complaint(scene).substr(0, 80),
            "grid.h: h = 3.051757812e-05 m with 4 points per cell makes 3.44e+08 points, more");
  scene.bodies.clear();
  EXPECT_EQ(complaint(scene), "body: a scene needs at least one [[body]]");
}

TEST(Scene, laws_and_initial_states_are_tried) {
  Scene scene = clay();
  scene.bodies[0].law.values["kappa"] = 0.02;
  EXPECT_EQ(complaint(scene),
            "body[0].law.kappa: kappa must be < lambda: swelling is stiffer than compression");
  scene = clay();
  scene.bodies[0].initial.ocr = 0.5;
  EXPECT_EQ(complaint(scene), "body[0].initial.ocr: ocr = p_c/p must be >= 1");
  scene = clay();
  scene.bodies[0].law.values.erase("N");
  EXPECT_EQ(complaint(scene).substr(0, 18), "body[0].law.Gamma:");
}

TEST(Scene, relaxed_needs_a_time_without_gravity) {
  Scene scene = sound();
  scene.gravity = 0.0;
  scene.transfer = Transfer::relaxed;
  EXPECT_EQ(complaint(scene),
            "step.transfer: without gravity, \"relaxed\" needs step.relaxation_time [s]");
  scene.relaxation_time = 1e-3;
  EXPECT_EQ(complaint(scene), "");
}

TEST(Scene, a_lithostatic_state_follows_from_the_weight) {
  Scene scene = clay();
  scene.bodies[0].initial = {};
  scene.bodies[0].lithostatic = true;
  scene.bodies[0].initial.K0 = 0.6;
  EXPECT_EQ(complaint(scene), "");
  scene.bodies[0].initial.p = 1e3;
  EXPECT_EQ(complaint(scene),
            "body[0].initial.lithostatic: a lithostatic state follows from the weight: beside it "
            "only K0 and ocr can be given");
  scene.bodies[0].initial.p.reset();
  scene.gravity = 0.0;
  EXPECT_EQ(complaint(scene),
            "body[0].initial.lithostatic: a lithostatic state needs gravity towards the floor");
  // q/p = 3(1 − K0)/(1 + 2K0) = 1.71 > √3·0.38 = 0.66: beyond yield
  scene = sound();
  scene.bodies[0].lithostatic = true;
  scene.bodies[0].initial.K0 = 0.2;
  EXPECT_EQ(
      complaint(scene),
      "body[0].initial.K0: the initial stress is beyond yield: tau/p must be <= mu_0 at rest");
}

TEST(Scene, transfers_that_do_not_go_with_all_walls_and_solvers) {
  Scene scene = sound();
  scene.left = scene.right = {Wall::Kind::periodic};
  for (const Transfer transfer : {Transfer::pic, Transfer::flip, Transfer::apic, Transfer::aflip,
                                  Transfer::relaxed, Transfer::tpic}) {
    scene.transfer = transfer;
    EXPECT_EQ(complaint(scene), "") << name_of(transfer);
  }
  for (const Transfer transfer : {Transfer::xpic, Transfer::fmpm}) {
    const std::string why =
        ": a periodic edge or a wall that moves does not go with step.transfer = \"" +
        std::string(name_of(transfer)) + "\" yet; any other transfer does";
    scene = sound();
    scene.transfer = transfer;
    EXPECT_EQ(complaint(scene), "");
    scene.left = scene.right = {Wall::Kind::periodic};
    EXPECT_EQ(complaint(scene), "domain.left" + why);
    scene = sound();
    scene.transfer = transfer;
    scene.floor = {Wall::Kind::no_slip};
    EXPECT_EQ(complaint(scene), "");
    scene.floor.speed = 0.1;
    EXPECT_EQ(complaint(scene), "domain.floor" + why);
  }

  scene = sound();
  scene.bodies[0].law.options["form"] = "regularised";
  scene.viscosity = Viscosity::implicit_solve;
  for (const Transfer transfer :
       {Transfer::pic, Transfer::flip, Transfer::apic, Transfer::aflip, Transfer::relaxed}) {
    scene.transfer = transfer;
    EXPECT_EQ(complaint(scene), "") << name_of(transfer);
  }
  for (const Transfer transfer : {Transfer::tpic, Transfer::xpic, Transfer::fmpm}) {
    scene.transfer = transfer;
    EXPECT_EQ(complaint(scene),
              "step.transfer: transfer = \"" + std::string(name_of(transfer)) +
                  "\" does not go with step.viscosity = \"implicit\": the strain rates that it "
                  "solves for are the affine gradients of \"relaxed\", \"apic\", \"aflip\", "
                  "\"flip\" and \"pic\"");
  }
}

}  // namespace
}  // namespace repose::mpm
