// Reading scenes: what is read, and the whole text of every complaint with its file:line:column.
#include "input/read_scene.hpp"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "input/resolved_scene.hpp"
#include "io/atomic_file.hpp"

namespace repose::input {
namespace {

namespace fs = std::filesystem;

// The line numbers in the tests below count from here.
const std::string granular =
    "[scene]\n"               // 1
    "end_time = 1.2\n"        // 2
    "[domain]\n"              // 3
    "size = [1.2, 0.5625]\n"  // 4
    "[[body]]\n"              // 5
    "size = [0.2, 0.4]\n"     // 6
    "[body.law]\n"            // 7
    "name = \"mu_i\"\n"       // 8
    "mu_0 = 0.3819\n"         // 9
    "mu_d = 0.5718\n"         // 10
    "I_0 = 0.279\n"           // 11
    "d = 0.0053\n"            // 12
    "rho_p = 2000\n"          // 13
    "rho_0 = 1300\n"          // 14
    "K = 254800\n"            // 15
    "[grid]\n"                // 16
    "h = 0.00625\n";          // 17
const std::string clay =
    "[scene]\n"                            // 1
    "end_time = 1.2\n"                     // 2
    "[domain]\n"                           // 3
    "size = [1.2, 0.5625]\n"               // 4
    "[[body]]\n"                           // 5
    "size = [0.2, 0.4]\n"                  // 6
    "initial = { p = 2.27, ocr = 1.0 }\n"  // 7
    "  [body.law]\n"                       // 8
    "  name = \"modified_cam_clay\"\n"     // 9
    "  compression = \"ln_v-ln_p\"\n"      // 10
    "  M = 0.6614\n"                       // 11
    "  lambda = 0.0186\n"                  // 12
    "  kappa = 0.0010\n"                   // 13
    "  nu = 0.3\n"                         // 14
    "  Gamma = 1.5432098765\n"             // 15
    "  p_ref = 1\n"                        // 16
    "[grid]\n"                             // 17
    "h = 0.00625\n";                       // 18

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

SceneFile scene_of(const std::string& text, const std::vector<std::string>& sets = {}) {
  InputFile file = InputFile::parse(text, "s.toml", sets);
  return read_scene(file);
}

/// Everything that is wrong, one problem per line; "" if nothing is.
std::string problems(const std::string& text, const std::vector<std::string>& sets = {}) {
  try {
    scene_of(text, sets);
  } catch (const BadInput& error) {
    return error.what();
  }
  return "";
}

TEST(ReadScene, fills_in_the_defaults) {
  const mpm::Scene scene = scene_of(granular).scene;
  EXPECT_EQ(scene.name, "s");
  EXPECT_EQ(scene.end_time, 1.2);
  EXPECT_EQ(scene.gravity, 9.8);
  EXPECT_EQ(scene.floor.kind, mpm::Wall::Kind::no_slip);
  EXPECT_EQ(scene.right.kind, mpm::Wall::Kind::slip);
  EXPECT_EQ(scene.points_per_cell, 4);
  EXPECT_EQ(scene.kernel, mpm::Kernel::cubic);
  EXPECT_EQ(scene.courant, 0.8);
  EXPECT_EQ(scene.transfer, mpm::Transfer::relaxed);
  EXPECT_EQ(scene_of(replaced(granular, "[domain]", "gravity = 0.0\n[domain]")).scene.transfer,
            mpm::Transfer::apic)
      << "nothing to derive a relaxation time from";
  EXPECT_FALSE(scene.dt);
  ASSERT_EQ(scene.bodies.size(), 1U);
  EXPECT_EQ(scene.bodies[0].law.options.at("form"), "elastoviscoplastic");
  EXPECT_EQ(scene.bodies[0].law.values.at("K"), 254800.0);
  EXPECT_FALSE(scene.bodies[0].law.values.contains("G")) << "4K follows K, so it stays absent";
}

TEST(ReadScene, a_map_that_never_ends_is_refused) {
  for (const std::string key : {"ground", "release", "friction"}) {
    const std::string said = problems(
        replaced(granular, "[domain]", "[terrain]\n" + key + " = \"/dev/zero\"\n[domain]"));
    EXPECT_NE(said.find("s.toml:4:1: /dev/zero: is longer than 32 MB, or never ends"),
              std::string::npos)
        << key << ": " << said;
  }
}

TEST(ReadScene, writes_out_the_defaults_of_a_law) {
  const LawSpec law = scene_of(clay).scene.bodies[0].law;
  EXPECT_EQ(law.values.at("rho_p"), 2650.0);
  EXPECT_EQ(law.values.at("p_sep"), 1e-2);
  EXPECT_FALSE(law.values.contains("N"));
}

TEST(ReadScene, walls_apply_to_three_edges_unless_one_is_named) {
  const mpm::Scene scene =
      scene_of(replaced(granular, "[[body]]",
                        "walls = { friction = 0.4 }\nright = \"open\"\nfloor = \"slip\"\n[[body]]"))
          .scene;
  EXPECT_EQ(scene.floor.kind, mpm::Wall::Kind::slip);
  EXPECT_EQ(scene.left.kind, mpm::Wall::Kind::friction);
  EXPECT_EQ(scene.top.friction, 0.4);
  EXPECT_EQ(scene.right.kind, mpm::Wall::Kind::open);
}

TEST(ReadScene, an_edge_in_parts) {
  const std::string parts =
      "floor = [{ from = 0.2, to = 0.5, kind = \"open\" }, { to = 0.3, friction = 0.4 }, "
      "{ speed = 0.1 }]\n[[body]]";
  const SceneFile file = scene_of(replaced(granular, "[[body]]", parts));
  const mpm::Wall& floor = file.scene.floor;
  ASSERT_EQ(floor.kind, mpm::Wall::Kind::parts);
  ASSERT_EQ(floor.parts.size(), 3U);
  EXPECT_EQ(floor.parts[0].kind, mpm::Wall::Kind::open);
  EXPECT_EQ(floor.parts[0].from[0], 0.2);
  EXPECT_EQ(floor.parts[0].to[0], 0.5);
  EXPECT_EQ(floor.parts[1].kind, mpm::Wall::Kind::friction);
  EXPECT_EQ(floor.parts[1].friction, 0.4);
  EXPECT_EQ(floor.parts[1].from[0], -HUGE_VAL);
  EXPECT_EQ(floor.parts[2].kind, mpm::Wall::Kind::no_slip);
  EXPECT_EQ(floor.parts[2].speed, 0.1);
  // what is written of it reads as the same
  const std::string written = resolved_input(file, "test");
  EXPECT_EQ(resolved_input(scene_of(written), "test"), written);
  const auto problem = [&](const std::string& list) {
    return problems(replaced(granular, "[[body]]", "floor = " + list + "\n[[body]]"));
  };
  EXPECT_NE(problem("[{ kind = \"opne\" }]").find("domain.floor[0].kind must be one of"),
            std::string::npos);
  EXPECT_NE(problem("[{ kind = \"periodic\" }]").find("domain.floor[0].kind must be one of"),
            std::string::npos);
  EXPECT_NE(problem("[{ to = 1.0 }]").find("domain.floor[0] needs one of kind"), std::string::npos);
  EXPECT_NE(problem("[{ kind = \"slip\", friction = 0.3 }]").find("needs one of kind"),
            std::string::npos);
  EXPECT_NE(problem("[{ kind = \"slip\", form = 1.0 }]").find("form"), std::string::npos);
  EXPECT_NE(problem("[{ kind = \"slip\", from = \"a\" }]").find("domain.floor[0].from"),
            std::string::npos);
  EXPECT_NE(problem("[{ kind = \"slip\", to = 0.3 }]").find("no part of the edge holds in"),
            std::string::npos);
  EXPECT_NE(problem("[]").find("domain.floor"), std::string::npos);
}

TEST(ReadScene, inflows_probes_and_tracers) {
  const std::string text =
      replaced(granular, "[grid]",
               "[[inflow]]\nedge = \"top\"\nfrom = 0.1\nto = 0.2\nrate = 3.0\nstops = 0.5\n"
               "[[probe]]\nname = \"gauge\"\nplace = [0.1, 0.1]\n[[tracer]]\nplace = [0.1, 0.2]\n"
               "[grid]");
  const SceneFile file = scene_of(text);
  ASSERT_EQ(file.scene.inflows.size(), 1U);
  const mpm::Inflow& inflow = file.scene.inflows[0];
  EXPECT_EQ(mpm::edge_names[inflow.edge], "top");
  EXPECT_EQ(inflow.from[0], 0.1);
  EXPECT_EQ(inflow.rate, 3.0);
  EXPECT_FALSE(inflow.speed);
  EXPECT_EQ(inflow.stops, 0.5);
  ASSERT_EQ(file.scene.probes.size(), 1U);
  EXPECT_EQ(file.scene.probes[0].name, "gauge");
  EXPECT_EQ(file.scene.tracers.at(0).name, "0");
  EXPECT_EQ(file.scene.tracers[0].place[1], 0.2);
  const std::string written = resolved_input(file, "test");
  EXPECT_EQ(resolved_input(scene_of(written), "test"), written);
  const auto problem = [&](const char* old, const char* fresh) {
    return problems(replaced(text, old, fresh));
  };
  EXPECT_NE(problem("stops = 0.5", "body = \"snad\"").find("is no body: there is \""),
            std::string::npos);
  EXPECT_NE(problem("edge = \"top\"", "").find("inflow"), std::string::npos);
  EXPECT_NE(problem("rate = 3.0", "rate = -3.0").find("inflow[0].rate"), std::string::npos);
  EXPECT_NE(problem("rate = 3.0", "rate = 3.0\nspeed = 1.0").find("give either speed or rate"),
            std::string::npos);
  EXPECT_NE(problem("\"gauge\"", "\"a/b\"").find("becomes part of a file name"), std::string::npos);
}

TEST(ReadScene, a_periodic_box_with_a_moving_lid) {
  const mpm::Scene scene =
      scene_of(
          replaced(granular, "[[body]]", "walls = \"periodic\"\ntop = { speed = 0.25 }\n[[body]]"))
          .scene;
  EXPECT_EQ(scene.left.kind, mpm::Wall::Kind::periodic);
  EXPECT_EQ(scene.right.kind, mpm::Wall::Kind::periodic);
  EXPECT_EQ(scene.top.kind, mpm::Wall::Kind::no_slip);
  EXPECT_EQ(scene.top.speed, 0.25);
  EXPECT_EQ(
      scene_of(replaced(granular, "[[body]]", "walls = \"periodic\"\n[[body]]")).scene.top.kind,
      mpm::Wall::Kind::slip);
  EXPECT_EQ(problems(replaced(granular, "[[body]]", "left = \"periodic\"\n[[body]]")),
            "s.toml:3:2: where one of left and right is periodic the other must be so too");
  EXPECT_EQ(problems(replaced(granular, "[[body]]", "top = \"periodic\"\n[[body]]")),
            "s.toml:5:1: only left and right can be periodic");
}

TEST(ReadScene, a_disc_has_a_centre_and_a_radius) {
  const std::string disc =
      replaced(granular, "size = [0.2, 0.4]",
               "shape = \"disc\"\ncentre = [0.3, 0.2]\nradius = 0.1\nhole = 0.05");
  const mpm::Body body = scene_of(disc).scene.bodies.at(0);
  ASSERT_TRUE(body.disc);
  EXPECT_EQ(body.disc->hole, 0.05);
  EXPECT_EQ(body.size, (std::array{0.2, 0.2, 0.0}));
  EXPECT_DOUBLE_EQ(body.origin[1], 0.1);
  EXPECT_EQ(problems(replaced(disc, "hole = 0.05", "hole = 0.15")),
            "s.toml:9:1: hole = 0.15 is out of range: must be [0, radius = 0.1)");
}

TEST(ReadScene, tension_cutoff_is_a_boolean) {
  const std::string fluid =
      "[scene]\nend_time = 1\n[domain]\nsize = [1, 1]\n[[body]]\nsize = [0.5, 0.5]\n"
      "law = { name = \"newtonian\", eta = 0.002, K = 26000, rho_0 = 1000, tension_cutoff = false "
      "}\n[grid]\nh = 0.125\n";
  EXPECT_EQ(scene_of(fluid).scene.bodies[0].law.options.at("tension_cutoff"), "false");
  EXPECT_EQ(scene_of(fluid).scene.bodies[0].law.values.at("alpha"), 7.0);
  EXPECT_EQ(problems(replaced(fluid, "= false", "= \"no\"")),
            "s.toml:7:67: body[0].law.tension_cutoff must be one of true, false; got the string "
            "\"no\"");
}

TEST(ReadScene, raises_the_top_of_the_box_to_whole_cells) {
  const SceneFile file = scene_of(replaced(granular, "0.5625", "0.56"));
  EXPECT_EQ(file.scene.domain[1], 0.5625);
  ASSERT_EQ(file.notes.size(), 1U);
  EXPECT_EQ(file.notes[0],
            "domain.size: the box is 0.5625 m high instead of 0.56 m, a whole number of cells (h = "
            "0.00625 m)");
}

TEST(ReadSceneErrors, unknown_keys) {
  EXPECT_EQ(problems(granular + "points_per_cel = 4\n"),
            "s.toml:18:1: unknown key 'points_per_cel' in [grid]; did you mean 'points_per_cell'?");
  EXPECT_EQ(problems(granular + "courant = 0.3\n"),
            "s.toml:18:1: unknown key 'courant' in [grid]; it belongs in [step]");
  EXPECT_EQ(problems(granular + "water = 1\n"),
            "s.toml:18:1: unknown key 'water' in [grid]; [grid] takes h, kernel, points_per_cell");
  EXPECT_EQ(problems(granular + "[outptu]\n"),
            "s.toml:18:2: unknown table 'outptu' in the file; did you mean 'output'?");
  EXPECT_EQ(
      problems(replaced(granular, "mu_0 =", "mu0 =")),
      "s.toml:7:7: mu_i needs mu_0 (friction coefficient at rest), a number > 0, or phi_0, its "
      "friction angle in degrees\n"
      "s.toml:9:1: mu_i has no parameter 'mu0'; did you mean 'mu_0'?");
  EXPECT_EQ(problems(replaced(granular, "name =", "from = \"regularised\"\nname =")),
            "s.toml:8:1: mu_i has no option 'from'; its option is 'form'");
}

TEST(ReadSceneErrors, wrong_types) {
  EXPECT_EQ(problems(replaced(granular, "h = 0.00625", "h = \"0.00625\"")),
            "s.toml:17:1: grid.h must be a number > 0 m (cell size); got the string \"0.00625\": "
            "leave out the quotes");
  EXPECT_EQ(problems(replaced(granular, "K = 254800", "K = true")),
            "s.toml:15:1: body[0].law.K must be a number > 0 Pa (bulk modulus); got true");
  EXPECT_EQ(problems(replaced(granular, "[0.2, 0.4]", "0.2")),
            "s.toml:6:1: body[0].size must be a list of 2 numbers in m (width, height and in space "
            "depth of a box); got the "
            "number 0.2");
  EXPECT_EQ(problems(replaced(granular, "[0.2, 0.4]", "[0.2, \"b\"]")),
            "s.toml:6:14: body[0].size[1] must be a number > 0 m (width, height and in space depth "
            "of a box); got the "
            "string \"b\"");
  EXPECT_EQ(problems(granular + "points_per_cell = 4.5\n"),
            "s.toml:18:1: grid.points_per_cell must be an integer from 1 to 100 (a square number: "
            "1, 4, 9, 16; in space a cube: 1, 8, 27); got the number 4.5");
  EXPECT_EQ(problems(granular + "kernel = \"qubic\"\n"),
            "s.toml:18:1: grid.kernel must be one of \"quadratic\", \"cubic\"; got the string "
            "\"qubic\"; did you mean \"cubic\"?");
  EXPECT_EQ(problems(replaced(granular, "[[body]]", "[body]")),
            "s.toml:5:2: body must be a list of tables, each headed [[body]] (a block of "
            "material); got a table");
}

TEST(ReadSceneErrors, values_out_of_range) {
  EXPECT_EQ(problems(replaced(granular, "rho_0 = 1300", "rho_0 = -1300")),
            "s.toml:14:1: body[0].law.rho_0 = -1300 kg/m³ is out of range: bulk density at p = 0 "
            "must be a number > 0 kg/m³");
  EXPECT_EQ(problems(replaced(clay, "ocr = 1.0", "density = -5")),
            "s.toml:7:23: body[0].initial.density = -5 kg/m³ is out of range: density must be a "
            "number > 0 kg/m³");
  EXPECT_EQ(problems(replaced(clay, "kappa = 0.0010", "kappa = 0.0186")),
            "s.toml:13:3: kappa must be < lambda: swelling is stiffer than compression");
  EXPECT_EQ(problems(replaced(clay, "nu = 0.3", "nu = 0.5")),
            "s.toml:14:3: body[0].law.nu = 0.5 is out of range: Poisson's ratio must be a number "
            "in [0, 0.5)");
  EXPECT_EQ(problems(replaced(granular, "end_time = 1.2", "end_time = nan")),
            "s.toml:2:1: scene.end_time = nan s is out of range: how long to simulate must be a "
            "number >= 0 s");
}

// The walk through all keys asks each table for its own ranges; these are known without it.
TEST(ReadSceneErrors, the_least_and_the_most_that_make_sense) {
  const auto refused = [](const std::string& set) {
    const std::string text = problems(granular, {set});
    return text.find(set.substr(0, set.find('='))) != text.npos;
  };
  for (const char* set : {"scene.tilt_deg=91", "scene.tilt_deg=-91", "scene.tilt_deg=120",
                          "scene.end_time=-1", "grid.h=0", "grid.h=-0.01", "step.courant=0",
                          "step.courant=1.41", "body[0].law.mu_0=-0.1", "body[0].law.K=0"})
    EXPECT_TRUE(refused(set)) << set << ": " << problems(granular, {set});
  // sizes beyond all reason are refused at once, before anything counts cells in integers
  for (const char* set : {"grid.h=1e-308", "grid.h=1e-20", "grid.h=1e-9", "grid.h=1e300",
                          "domain.size=[1e17,0.5]", "domain.size=[1e300,1e300]",
                          "domain.size=[1e-300,1e-300]", "output.series_interval=1e-300"})
    EXPECT_NE(problems(granular, {set}), "") << set;
  for (const char* set : {"scene.tilt_deg=90", "scene.tilt_deg=-90", "step.courant=1.4"})
    EXPECT_EQ(problems(granular, {set}), "") << set;
}

TEST(ReadSceneErrors, a_missing_key_is_reported_at_its_table) {
  EXPECT_EQ(problems(replaced(granular, "h = 0.00625\n", "")),
            "s.toml:16:2: [grid] needs h, a number > 0 m (cell size)");
  EXPECT_EQ(problems(replaced(granular, "[grid]\nh = 0.00625\n", "")),
            "s.toml:1:1: [grid] needs h, a number > 0 m (cell size)");
  EXPECT_EQ(problems(replaced(granular, "K = 254800\n", "")),
            "s.toml:7:7: mu_i needs K (bulk modulus), a number > 0 Pa");
  EXPECT_EQ(problems(replaced(clay, "  compression = \"ln_v-ln_p\"\n", "")),
            "s.toml:8:9: modified_cam_clay needs compression, one of \"ln_v-ln_p\", \"v-ln_p\": "
            "the same numbers mean different laws");
}

TEST(ReadSceneErrors, all_of_them_in_the_order_of_the_file) {
  std::string text = replaced(granular, "end_time = 1.2", "end_time = -1");
  text = replaced(text, "h = 0.00625", "hh = 0.00625");
  text = replaced(text, "mu_0 = 0.3819", "mu_0 = 0");
  EXPECT_EQ(problems(text),
            "s.toml:2:1: scene.end_time = -1 s is out of range: how long to simulate must be a "
            "number >= 0 s\n"
            "s.toml:9:1: body[0].law.mu_0 = 0 is out of range: friction coefficient at rest must "
            "be a number > 0\n"
            "s.toml:16:2: [grid] needs h, a number > 0 m (cell size)\n"
            "s.toml:17:1: unknown key 'hh' in [grid]; did you mean 'h'?");
}

TEST(ReadSceneErrors, geometry) {
  EXPECT_EQ(problems(replaced(granular, "size = [0.2", "origin = [1.1, 0]\nsize = [0.2")),
            "s.toml:6:1: the body reaches from x = 1.1 to 1.3 m, outside the box [0, 1.2] m");
  EXPECT_EQ(problems(replaced(granular, "0.4]", "0.6]")),
            "s.toml:6:1: the body reaches from y = 0 to 0.6 m, outside the box [0, 0.5625] m");
  EXPECT_EQ(problems(replaced(granular, "h = 0.00625", "h = 0.0067")),
            "s.toml:17:1: h = 0.0067 m does not divide the box's width of 1.2 m (179.104 cells); h "
            "= 0.00625 or 0.008 m would");
  EXPECT_EQ(problems(replaced(granular, "[0.2, 0.4]", "[0.198, 0.396]")),
            "s.toml:6:1: the points cannot represent 0.198 m along x exactly: they stand 0.003125 "
            "m apart (h/2); 0.196875 or 0.2 m would do, or h = 0.006 or 0.012 m");
  EXPECT_EQ(problems(granular + "points_per_cell = 5\n"),
            "s.toml:18:1: points_per_cell = 5 must be a square number from 1 to 100: 1, 4, 9, 16, "
            "...");
}

TEST(ReadSceneErrors, relaxation_time_belongs_to_relaxed) {
  EXPECT_EQ(problems(granular + "[step]\ntransfer = \"relaxed\"\nrelaxation_time = 1e-3\n"), "");
  EXPECT_EQ(problems(granular + "[step]\nrelaxation_time = 1e-3\n"), "") << "the default";
  EXPECT_EQ(problems(granular + "[step]\ntransfer = \"apic\"\nrelaxation_time = 1e-3\n"),
            "s.toml:20:1: only step.transfer = \"relaxed\" has a relaxation time");
  EXPECT_EQ(problems(granular + "[step]\ntransfer = \"relaxd\"\n"),
            "s.toml:19:1: step.transfer must be one of \"pic\", \"flip\", \"apic\", \"aflip\", "
            "\"relaxed\", \"tpic\", \"xpic\", \"fmpm\"; got the string \"relaxd\"; did you mean "
            "\"relaxed\"?");
}

TEST(ReadSceneErrors, order_belongs_to_xpic_and_fmpm) {
  EXPECT_EQ(problems(granular + "[step]\ntransfer = \"xpic\"\norder = 5\n"), "");
  EXPECT_EQ(problems(granular + "[step]\ntransfer = \"fmpm\"\n"), "");
  EXPECT_EQ(problems(granular + "[step]\norder = 2\n"),
            "s.toml:19:1: only step.transfer = \"xpic\" and \"fmpm\" have an order");
  EXPECT_EQ(
      problems(granular + "[step]\ntransfer = \"xpic\"\norder = 0\n"),
      "s.toml:20:1: step.order must be an integer from 1 to 100 (of the transfer, 1 is pic); got "
      "the integer 0");
}

TEST(ReadSceneErrors, implicit_viscosity_needs_a_viscosity_and_walls_it_can_hold) {
  const std::string fluid =
      replaced(granular, "name = \"mu_i\"", "name = \"mu_i\"\nform = \"regularised\"");
  const std::string implicit = "[step]\nviscosity = \"implicit\"\n";
  EXPECT_EQ(problems(fluid + implicit + "viscosity_tolerance = 1e-4\n"), "");
  EXPECT_EQ(
      problems(granular + implicit),
      "s.toml:19:1: viscosity = \"implicit\" needs a body whose law is a viscosity: newtonian, "
      "or mu_i with form = \"regularised\"");
  EXPECT_EQ(
      problems(replaced(fluid, "0.5625]\n", "0.5625]\nfloor = { friction = 0.4 }\n") + implicit),
      "s.toml:5:1: a wall with friction does not go with step.viscosity = \"implicit\": its "
      "limit on the shear is not part of the solve; \"no_slip\", \"slip\" and \"open\" do");
  EXPECT_EQ(
      problems(fluid + implicit + "transfer = \"tpic\"\n"),
      "s.toml:21:1: transfer = \"tpic\" does not go with step.viscosity = \"implicit\": the strain "
      "rates that it solves for are the affine gradients of \"relaxed\", \"apic\", \"aflip\", "
      "\"flip\" and \"pic\"");
  EXPECT_EQ(problems(fluid + "[step]\nviscosity = \"implicite\"\n"),
            "s.toml:20:1: step.viscosity must be one of \"explicit\", \"implicit\"; got the string "
            "\"implicite\"; did you mean \"implicit\"?");
  EXPECT_EQ(problems(fluid + "[step]\nviscosity_tolerance = 1e-4\n"),
            "s.toml:20:1: only step.viscosity = \"implicit\" has a tolerance");
  EXPECT_EQ(
      problems(fluid + implicit + "viscosity_tolerance = 0.5\n"),
      "s.toml:21:1: step.viscosity_tolerance = 0.5 is out of range: error of an implicit step's "
      "velocity over what its forces bring must be a number in (0, 0.1]");
}

TEST(ReadSceneErrors, courant_or_dt) {
  EXPECT_EQ(problems(granular + "[step]\ncourant = 0.3\ndt = 1e-5\n"),
            "s.toml:20:1: give either step.courant or step.dt: a fixed step leaves no choice");
  EXPECT_EQ(
      problems(granular + "[step]\ncourant = 1.5\n"),
      "s.toml:19:1: step.courant = 1.5 is out of range: share of the largest stable step must be a "
      "number in (0, 1.4]");
}

TEST(Overrides, replace_and_add_keys) {
  const SceneFile file =
      scene_of(granular, {"grid.h=0.0125", "body[0].law.K=26e3", "output.colour=density",
                          "domain.size[0]=0.6", "scene.name=\"a b\"", "scene.name=coarse"});
  EXPECT_EQ(file.scene.h, 0.0125);
  EXPECT_EQ(file.scene.bodies[0].law.values.at("K"), 26e3);
  EXPECT_EQ(file.colour, PictureField::density);
  EXPECT_EQ(file.scene.domain[0], 0.6);
  EXPECT_EQ(file.scene.name, "coarse");
}

TEST(Overrides, of_the_step_replace_the_choice_in_the_file) {
  const std::string with_courant = granular + "[step]\ncourant = 0.3\n";
  EXPECT_EQ(scene_of(with_courant, {"step.dt=1e-5"}).scene.dt, 1e-5);
  const std::string with_dt = granular + "[step]\ndt = 1e-5\n";
  const mpm::Scene scene = scene_of(with_dt, {"step.courant=0.2"}).scene;
  EXPECT_FALSE(scene.dt);
  EXPECT_EQ(scene.courant, 0.2);
}

TEST(Overrides, complaints_point_at_the_text) {
  EXPECT_EQ(problems(granular, {"grid.h=-1"}),
            "--set grid.h=-1: grid.h = -1 m is out of range: cell size must be a number > 0 m");
  EXPECT_EQ(problems(granular, {"gird.h=1"}),
            "--set gird.h=1: unknown table 'gird' in the file; did you mean 'grid'?");
  EXPECT_EQ(problems(granular, {"grid.h"}),
            "--set grid.h: needs the form key=value, as in --set grid.h=0.0125");
  EXPECT_EQ(problems(granular, {"grid.h="}), "--set grid.h=: grid.h gets no value");
  EXPECT_EQ(problems(granular, {"grid..h=1"}), "--set grid..h=1: 'grid..h' is not a key");
  EXPECT_EQ(problems(granular, {"body[1].name=b"}), "--set body[1].name=b: there is only body[0]");
  EXPECT_EQ(problems(granular, {"body.name=b"}),
            "--set body.name=b: body is a list, not a table; the first entry is body[0]");
  EXPECT_EQ(problems(granular, {"grid.h.x=1"}), "--set grid.h.x=1: grid.h is a value, not a table");
  EXPECT_EQ(problems(granular, {"grid.h=1..2"}).substr(0, 42),
            "--set grid.h=1..2: 1..2 is not a TOML valu");
  EXPECT_EQ(problems(clay, {"body[0].law.kappa=0.02"}),
            "--set body[0].law.kappa=0.02: kappa must be < lambda: swelling is stiffer than "
            "compression");
}

TEST(InputFileErrors, broken_toml_has_a_place) {
  const std::string text = problems(replaced(granular, "size = [1.2, 0.5625]", "size = [1.2, "));
  EXPECT_EQ(text.substr(0, 9), "s.toml:5:") << text;
}

TEST(InputFileErrors, files_that_cannot_be_read) {
  const auto reason = [](const fs::path& path) {
    try {
      InputFile::read(path);
    } catch (const io::IoError& error) {
      return std::string(error.what());
    }
    return std::string("it was read");
  };
  const std::string scenes = REPOSE_SOURCE_DIR "/data/scenes";
  EXPECT_EQ(reason(scenes), scenes + ": is a folder; give the .toml file in it");
  EXPECT_EQ(reason(scenes + "/flat_mu_j.toml"),
            scenes + "/flat_mu_j.toml: there is no such file; did you mean " + scenes +
                "/flat_mu_i.toml?");
  EXPECT_EQ(
      reason(scenes + "/flat_mcc"),
      scenes + "/flat_mcc: there is no such file; did you mean " + scenes + "/flat_mcc.toml?");
}

const std::string space = [] {
  std::string text = replaced(granular, "size = [1.2, 0.5625]", "size = [0.3, 0.2, 0.3]");
  text = replaced(text, "size = [0.2, 0.4]",
                  "shape = \"cylinder\"\ncentre = [0, 0]\nradius = 0.1\nheight = 0.1");
  return replaced(text, "h = 0.00625", "h = 0.0125");
}();

TEST(SpaceScenes, read_a_quarter_of_a_cylinder) {
  InputFile file = InputFile::parse(space, "scene.toml");
  const mpm::Scene scene = read_scene(file).scene;
  EXPECT_EQ(scene.dimensions(), 3u);
  EXPECT_EQ(scene.points_per_cell, 8);
  EXPECT_EQ(scene.courant, 0.65);
  const mpm::Body& body = scene.bodies.at(0);
  EXPECT_EQ(body.origin, (std::array{0.0, 0.0, 0.0}));
  EXPECT_EQ(body.size, (std::array{0.1, 0.1, 0.1}));
  EXPECT_EQ(body.disc.value().radius, 0.1);
}

TEST(SpaceScenes, complain_of_what_is_of_the_other_dimension) {
  const auto complaint = [](const std::string& text) {
    InputFile file = InputFile::parse(text, "scene.toml");
    try {
      read_scene(file);
    } catch (const BadInput& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  const auto says = [&](const std::string& text, const std::string& words) {
    const std::string found = complaint(text);
    EXPECT_NE(found.find(words), std::string::npos) << found;
  };
  says(replaced(space, "centre = [0, 0]", "centre = [0, 0]\nvelocity = [1, 0]"),
       "body[0].velocity must be a list of 3 numbers");
  says(replaced(space, "\"cylinder\"", "\"disc\""), "\"cylinder\"");
  says(replaced(granular, "size = [0.2, 0.4]", "size = [0.2, 0.4, 0.1]"),
       "body[0].size must be a list of 2 numbers");
  says(replaced(granular, "[[body]]", "near = \"slip\"\n[[body]]"), "near");
  says(replaced(space, "h = 0.0125", "h = 0.0125\npoints_per_cell = 4"),
       "must be a cube number up to 64 in three dimensions");
  says(space + "[step]\ntransfer = \"fmpm\"\n",
       "transfer = \"fmpm\" is for plane strain only: this scene has three dimensions");
  says(replaced(space, "[[body]]", "near = \"no_slip\"\n[[body]]"), "the wall cuts body[0]");
}

TEST(StartKeys, are_read_and_complain) {
  const auto read = [](const std::string& text) {
    InputFile file = InputFile::parse(text, "scene.toml");
    return read_scene(file);
  };
  const auto complaint = [&](const std::string& text) {
    try {
      read(text);
    } catch (const BadInput& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  const auto with = [&](const std::string& keys) {
    return replaced(granular, "end_time", keys + "\nend_time");
  };
  const SceneFile file = read(
      with("gravity_ramp = 0.5\nwater_table = 0.1\nwater_density = 1030\nstart = \"as_given\""));
  EXPECT_EQ(file.scene.gravity_ramp, 0.5);
  EXPECT_EQ(file.scene.water_table, 0.1);
  EXPECT_EQ(file.scene.water_density, 1030.0);
  EXPECT_EQ(file.scene.equilibrium, false);
  EXPECT_FALSE(file.final_state);
  EXPECT_FALSE(read(granular).scene.equilibrium.has_value());
  EXPECT_TRUE(read(granular + "[output]\nfinal_state = true\n").final_state);
  const SceneFile after = read(with("start_from = \"results/bed\""));
  EXPECT_EQ(after.scene.start_from, "results/bed");
  ASSERT_EQ(after.notes.size(), 1U);
  EXPECT_NE(after.notes[0].find("bodies start as results/bed has left them"), std::string::npos);
  const auto says = [&](const std::string& text, const std::string& words) {
    const std::string found = complaint(text);
    EXPECT_NE(found.find(words), std::string::npos) << found;
  };
  says(with("gravity_ramp = -1"), "gravity_ramp");
  says(with("water_density = 1030"), "only a scene with a water_table has a water_density");
  says(with("water_table = 0.1\ntilt_deg = 5"), "a water table is level");
  says(with("start = \"at_rest\""), "and there is none");
  says(with("start = \"at_rest\"\nstart_from = \"results/bed\""), "start_from");
  says(with("start = \"resting\""), "\"as_given\", \"at_rest\"");
}

TEST(ShippedScenes, are_sound) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(REPOSE_SOURCE_DIR "/data/scenes")) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    SCOPED_TRACE(entry.path());
    InputFile file = InputFile::read(entry.path());
    const SceneFile scene = read_scene(file);  // throws
    EXPECT_TRUE(scene.notes.empty());
    const bool reference = entry.path().parent_path().filename() == "reference";
    EXPECT_EQ(scene.scene.name, entry.path().stem().string() + (reference ? "_reference" : ""));
    EXPECT_EQ(scene.scene.dt.has_value(),
              reference || entry.path().stem() == "flat_mu_i_regularised");
    const bool column =
        scene.scene.name.starts_with("flat") || scene.scene.name.starts_with("tilted");
    if (!column) continue;
    const auto n = mpm::point_lattice(scene.scene, scene.scene.bodies.at(0));
    EXPECT_EQ(n[0] * n[1], 8192);
  }
  EXPECT_GE(count, 24) << "the folder holds fewer than were once shipped";
}

}  // namespace
}  // namespace repose::input
