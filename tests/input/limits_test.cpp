// What is refused before anything is allocated, because of its size alone.
#include <chrono>
#include <fstream>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "input/quantity_range.hpp"
#include "input/read_point_test.hpp"
#include "input/read_scene.hpp"
#include "input/read_sweep.hpp"
#include "input/schema.hpp"
#include "io/atomic_file.hpp"
#include "io/seal.hpp"
#include "mpm/step/simulation.hpp"
#include "mpm/study/estimate.hpp"
#include "mpm/study/needs.hpp"
#include "tests/scratch_folder.hpp"

namespace repose::input {
namespace {

constexpr const char* scene = R"([scene]
end_time = 1.0
[domain]
size = [1.2, 0.6]
[[body]]
size = [0.2, 0.4]
initial = { p = 1e3 }
[body.law]
name = "mu_i"
mu_0 = 0.38
mu_d = 0.57
I_0 = 0.279
d = 0.0053
rho_p = 2000.0
rho_0 = 1300.0
K = 254800.0
[grid]
h = 0.025
)";

constexpr const char* point = R"([law]
name = "modified_cam_clay"
compression = "v-ln_p"
M = 0.888
lambda = 0.161
kappa = 0.062
nu = 0.3
Gamma = 2.759
rho_p = 2650.0
[initial]
p = 20e3
[test]
kind = "triaxial"
axial_strain = 0.2
)";

/// The complaints about a file with overrides, one per line; "" if there are none.
std::string complaints(const char* text, const std::vector<std::string>& sets, bool is_scene) {
  try {
    InputFile file = InputFile::parse(text, "f.toml", sets);
    if (is_scene)
      read_scene(file);
    else
      read_point_test(file);
    return "";
  } catch (const BadInput& error) {
    return error.what();
  }
}

mpm::Scene scene_with(const std::vector<std::string>& sets) {
  InputFile file = InputFile::parse(scene, "f.toml", sets);
  return read_scene(file).scene;
}

/// Keys whose number has neither two finite ends of its own nor a unit with sizes.
void unbounded(const std::vector<KeyInfo>& keys, const std::string& path,
               std::vector<std::string>& found) {
  for (const KeyInfo& key : keys) {
    const bool number = key.kind == ValueKind::number || key.kind == ValueKind::number_list;
    const bool finite = std::isfinite(key.range.lower) && std::isfinite(key.range.upper);
    if (number && !finite && find_sensible_size(key.unit.empty() ? "-" : key.unit) == nullptr)
      found.push_back(path + key.name + " [" + key.unit + "]");
    unbounded(key.below, path + key.name + ".", found);
  }
}

TEST(Limits, EveryNumberOfEveryKindOfFileHasThem) {
  std::vector<std::string> found;
  for (std::size_t kind = 0; kind < schema_names.size(); ++kind)
    unbounded(keys_of(static_cast<SchemaKind>(kind)), std::string(schema_names[kind]) + ": ",
              found);
  for (const LawInfo& law : all_laws())
    for (const ParamInfo& parameter : law.parameters)
      if (find_sensible_size(parameter.unit) == nullptr)
        found.push_back(fmt::format("{} {}: {}", law.name, parameter.name, parameter.unit));
  std::string list;
  for (const std::string& one : found) list += one + "\n";
  EXPECT_EQ(list, "");
}

TEST(Limits, SizesThatNothingHasAreRefusedWithTheSizesThatThereAre) {
  EXPECT_EQ(complaints(scene, {"grid.h=1e-308"}, true),
            "--set grid.h=1e-308: grid.h = 1e-308 m is out of range (cell size): numbers here go "
            "from 1e-09 m");
  EXPECT_EQ(complaints(scene, {"domain.size=[1e17, 0.6]"}, true),
            "--set domain.size=[1e17, 0.6]: domain.size[0] = 1e+17 m is out of range (width and "
            "height of the box, in space also its depth): numbers here go up to 1e+06 m, whatever "
            "their sign");
  EXPECT_TRUE(complaints(point, {"test.p_end=1e80"}, false)
                  .starts_with("--set test.p_end=1e80: test.p_end = 1e+80 Pa is out of range (mean "
                               "stress to reach): numbers here go up to 1e+15 Pa"));
  for (const char* set :
       {"grid.h=1e-20", "scene.end_time=1e300", "scene.gravity=1e7", "body[0].velocity=[1e9, 0.0]",
        "body[0].law.K=1e20", "body[0].initial.p=1e80", "step.dt=1e-30"})
    EXPECT_NE(complaints(scene, {set}, true), "") << set;
  // where zero is allowed so is anything next to it, and the ends themselves are
  for (const char* set : {"scene.gravity=1e-30", "body[0].velocity=[1e-300, 0.0]",
                          "body[0].law.K=1e9", "scene.end_time=0"})
    EXPECT_EQ(complaints(scene, {set}, true), "") << set;
}

TEST(Limits, WhatAPointTestTakes) {
  EXPECT_EQ(complaints(point, {"test.points=1000000"}, false),
            "--set test.points=1000000: the test writes 1000002 rows, and 1000000 are the most: "
            "fewer points per stage, or fewer stages and cycles");
  const std::string cycles = complaints(
      "[test]\nkind = \"triaxial\"\ncycles = 10000\nq_min = 1e3\nq_max = 2e3\npoints = 100\n"
      "[initial]\np = 1e5\n[law]\nname = \"modified_cam_clay\"\ncompression = \"v-ln_p\"\n"
      "M = 0.9\nlambda = 0.16\nkappa = 0.06\nnu = 0.3\nGamma = 2.76\nrho_p = 2650.0\n",
      {}, false);
  EXPECT_NE(cycles.find("the test writes 2000000 rows"), cycles.npos) << cycles;
  EXPECT_NE(complaints(point,
                       {"test.points=100000", "integration.substeps=1000000",
                        "integration.method=\"implicit\""},
                       false)
                .find("of 1000000 substeps are 1e+11 steps"),
            std::string::npos);
}

TEST(Limits, NeedsAreCountedBeforeAnythingIsLaidOut) {
  for (const auto& sets : std::vector<std::vector<std::string>>{
           {}, {"grid.h=0.0125"}, {"step.transfer=\"apic\""}, {"grid.points_per_cell=16"}}) {
    const mpm::Scene given = scene_with(sets);
    const mpm::Needs needs = mpm::needs_of(given);
    const mpm::Simulation simulation(given, 1);
    EXPECT_EQ(std::llround(needs.points), simulation.point_count());
    const double laid_out = simulation.counters().memory_MB;
    EXPECT_GE(needs.memory_MB, laid_out);
    EXPECT_LE(needs.memory_MB, 4.0 * laid_out);
  }
}

TEST(Limits, FramesOfTheGridAreOfTheWholeBox) {
  const mpm::Scene without = scene_with({"output.frame_interval=0.1"});
  const mpm::Scene with = scene_with({"output.frame_interval=0.1", "output.grid_frames=true"});
  const mpm::Needs needs = mpm::needs_of(with);
  // mass and velocity of every node, at the least
  EXPECT_GE(needs.grid_frames_MB, needs.box_cells * 3 * sizeof(double) / 1e6);
  EXPECT_DOUBLE_EQ(needs.memory_MB - needs.grid_frames_MB, mpm::needs_of(without).memory_MB);
  EXPECT_EQ(mpm::needs_of(without).grid_frames_MB, 0.0);
}

TEST(Limits, ASceneThatTheMachineCannotHoldIsRefused) {
  const mpm::Scene given = scene_with({});
  EXPECT_NO_THROW(mpm::require_memory(given, mpm::needs_of(given).memory_MB));
  try {
    mpm::require_memory(given, 0.01);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), "grid.h");
    EXPECT_NE(std::string(error.what()).find("512 points"), std::string::npos) << error.what();
  }
}

TEST(Limits, AnEstimateOfAHundredMillionPointsTakesNoTime) {
  const mpm::Scene given =
      scene_with({"domain.size=[20, 20]", "grid.h=0.002", "body[0].size=[10, 10]"});
  const auto begun = std::chrono::steady_clock::now();
  // 100 million points of the box's two dimensions: some 20 GB if it were laid out
  mpm::Estimate estimate;
  try {
    estimate = mpm::estimate(given, 1);
    EXPECT_EQ(estimate.points, 100'000'000);
    EXPECT_GT(estimate.memory_MB, 10e3);
    EXPECT_GT(estimate.seconds, 1e4);
  } catch (const InputError& error) {  // a machine that has no such memory says so
    EXPECT_NE(std::string(error.what()).find("GB"), std::string::npos) << error.what();
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  EXPECT_LT(took.count(), 1.0);
}

TEST(Limits, AFileThatNeverEnds) {
  try {
    io::read_bytes("/dev/zero", 1'000'000);
    FAIL();
  } catch (const io::IoError& error) {
    EXPECT_STREQ(error.what(), "/dev/zero: is longer than 1 MB, or never ends");
  }
  try {  // whatever a caller takes, a device gets no gigabyte
    io::read_bytes("/dev/zero");
    FAIL();
  } catch (const io::IoError& error) {
    EXPECT_STREQ(error.what(), "/dev/zero: is longer than 32 MB, or never ends");
  }
  const ScratchFolder folder;
  std::ofstream(folder.path() / "exact") << "12345";
  EXPECT_EQ(io::read_bytes(folder.path() / "exact", 5), "12345");
  EXPECT_THROW(io::read_bytes(folder.path() / "exact", 4), io::IoError);
}

}  // namespace
}  // namespace repose::input
