/// The same bits: for any number of threads, and for a run that was stopped and resumed.

#include <fstream>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "io/atomic_file.hpp"
#include "tests/mpm/saved_state.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {
namespace {

/// All laws in one box with an open edge, in motion: sorting, several ranges per block, outflow.
Scene everything(Kernel kernel) {
  Scene scene = empty_box(1.0, 0.5, 0.0125);
  scene.kernel = kernel;
  scene.gravity = 9.8;
  scene.tilt_deg = 10.0;
  scene.right = {Wall::Kind::open};
  scene.left = {Wall::Kind::friction, 0.3};
  scene.floor = {Wall::Kind::no_slip};
  LawSpec viscous = mu_i(26000.0, "regularised");
  viscous.values["r"] = 1.0;
  const LawSpec laws[] = {mu_i(26000.0), newtonian(0.01, 26000.0, 7.0, 1300.0),
                          cam_clay(),    cam_clay("v-ln_p"),
                          viscous,       newtonian(0.01, 1e4, 1.0, 1000.0, true)};
  for (std::size_t b = 0; b < 6; ++b) {
    const double k = static_cast<double>(b);
    Body body =
        block(0.1 + 0.3 * static_cast<double>(b % 3), b < 3 ? 0.0 : 0.25, 0.2, 0.15, laws[b]);
    body.velocity = {4.0 - k, b < 3 ? 0.0 : -2.0};
    body.spin = k - 2.0;
    scene.bodies.push_back(body);
  }
  Body both =
      block(0.0125, 0.0, 0.0625, 0.1, critical_state());  // beside the others: a column that slumps
  both.restitution = 0.3;  // contacts that damp, with stresses of their own
  scene.bodies.push_back(both);
  scene.bodies[0].restitution = 0.5;
  scene.bodies[2].velocity[0] = 6.0;  // leaves at once
  Surface roller, gate;               // at rest and in motion
  roller.solid.shape = Ball{{0.65, 0.2, 0.0}, 0.04};
  roller.contact = Surface::Contact::friction;
  roller.friction = 0.3;
  gate.solid.shape = Polygon{{{0.62, -0.1}, {0.68, -0.1}, {0.68, 0.1}, {0.62, 0.1}}};
  gate.velocity = {0.0, 1.0, 0.0};
  gate.starts = 0.002;
  scene.surfaces = {roller, gate};
  return scene;
}

struct Method {
  Kernel kernel;
  Storage storage;
};

class DeterminismTest : public ::testing::TestWithParam<Method> {
 protected:
  static Scene scene_of_all() {
    Scene scene = everything(GetParam().kernel);
    scene.storage = GetParam().storage;
    return scene;
  }
};

TEST_P(DeterminismTest, AnyNumberOfThreads) {
  // four real threads, also where there are fewer cores
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  const Scene scene = scene_of_all();
  const auto run = [&](int threads) {
    Simulation simulation(scene, threads);
    run_steps(simulation, 400);
    EXPECT_EQ(simulation.counters().threads, threads);
    EXPECT_GT(simulation.counters().sorts, 5);
    EXPECT_GT(simulation.diagnostics().outflow_kg_per_m, 1.0);
    return saved_state(simulation);
  };
  const SavedState one = run(1);
  EXPECT_EQ(run(2), one);
  EXPECT_EQ(run(4), one);
  EXPECT_EQ(run(4), one) << "and every time";
}

TEST_P(DeterminismTest, StoppedAndResumed) {
  const Scene scene = scene_of_all();
  const int steps = 240;
  std::vector<SavedState> middle;
  const ScratchFile file;
  Simulation straight(scene, 2);
  std::vector<std::unique_ptr<Simulation>> resumed;
  for (int k = 0; k < steps; ++k) {
    if (k % 80 < 2) {  // at the very start, and around sorts and outflow as they come
      straight.save(file.path());
      resumed.push_back(std::make_unique<Simulation>(scene, k % 2 + 1));
      run_steps(*resumed.back(), k % 7);  // whatever it was before
      resumed.back()->load(file.path());
      EXPECT_EQ(saved_state(*resumed.back()), read_state(file.path()));
      EXPECT_EQ(resumed.back()->steps(), k);
      EXPECT_EQ(resumed.back()->point_count(), straight.point_count());
    }
    for (const auto& one : resumed) one->step(HUGE_VAL);
    straight.step(HUGE_VAL);
  }
  EXPECT_GT(straight.diagnostics().outflow_kg_per_m, 1.0);
  const SavedState end = saved_state(straight);
  const SeriesRow row = straight.diagnostics();
  const Simulation::Counters count = straight.counters();
  for (const auto& one : resumed) {
    EXPECT_EQ(saved_state(*one), end);
    // what a checkpoint lacks, two of them cannot differ in
    const SeriesRow its = one->diagnostics();
    EXPECT_EQ(its.dissipated_J_per_m, row.dissipated_J_per_m);
    EXPECT_EQ(its.transfer_loss_J_per_m, row.transfer_loss_J_per_m);
    EXPECT_EQ(its.wall_loss_J_per_m, row.wall_loss_J_per_m);
    EXPECT_EQ(its.energy_residual_J_per_m, row.energy_residual_J_per_m);
    EXPECT_EQ(its.outflow_kg_per_m, row.outflow_kg_per_m);
    EXPECT_EQ(its.dt_s, row.dt_s);
    EXPECT_EQ(one->time(), straight.time());
    EXPECT_EQ(one->next_dt(), straight.next_dt());
    EXPECT_EQ(one->point_steps(), straight.point_steps());
    EXPECT_EQ(one->counters().dt_min_s, count.dt_min_s);
    EXPECT_EQ(one->counters().dt_max_s, count.dt_max_s);
    EXPECT_EQ(one->counters().sorts, count.sorts);
    EXPECT_EQ(one->counters().wall_corrections, count.wall_corrections);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Kernels, DeterminismTest,
    ::testing::Values(Method{Kernel::cubic, Storage::double_precision},
                      Method{Kernel::quadratic, Storage::double_precision},
                      Method{Kernel::cubic, Storage::single_precision}),
    [](const auto& method) {
      return std::string(name_of(method.param.kernel)) + "_" +
             std::string(storage_names[static_cast<std::size_t>(method.param.storage)]);
    });

// Outputs at other times change the steps, but a series of stops is the same series anywhere.
TEST(StopsTest, AreMetExactlyAndTheSameAfterResuming) {
  const Scene scene = everything(Kernel::cubic);
  const ScratchFile file;
  Simulation straight(scene, 2);
  Simulation resumed(scene, 1);
  for (int k = 1; k <= 10; ++k) {
    const double stop = 0.003 * k;
    while (straight.time() < stop) straight.step(stop);
    EXPECT_EQ(straight.time(), stop);
    if (k == 5) straight.save(file.path());
  }
  resumed.load(file.path());
  for (int k = 6; k <= 10; ++k)
    while (resumed.time() < 0.003 * k) resumed.step(0.003 * k);
  EXPECT_EQ(saved_state(resumed), saved_state(straight));
}

// A byte that changes on the disk is noticed wherever it lies in the data: by the checksum of its
// chunk. (Unused bytes between them are nobody's.)
TEST(CheckpointTest, RefusesADamagedOne) {
  const Scene scene = everything(Kernel::cubic);
  const ScratchFile file;
  Simulation simulation(scene, 1);
  run_steps(simulation, 20);
  simulation.save(file.path());
  const SavedState whole = read_state(file.path());
  const std::string bytes = content_of(file.path());
  int refused = 0, tried = 0;
  for (std::size_t at = bytes.size() / 50; at < bytes.size(); at += bytes.size() / 25, ++tried) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    std::ofstream(file.path(), std::ios::binary) << damaged;
    Simulation other(scene, 1);
    try {
      other.load(file.path());
      EXPECT_EQ(saved_state(other), whole) << "byte " << at;  // or nothing was lost
    } catch (const io::IoError&) {
      ++refused;
    }
  }
  EXPECT_GE(refused, tried / 2);
}

TEST(CheckpointTest, RefusesWhatIsNone) {
  const Scene scene = everything(Kernel::cubic);
  Simulation simulation(scene, 1);
  const ScratchFile file;
  EXPECT_THROW(simulation.load(file.path()), io::IoError) << "absent";
  {
    std::ofstream out(file.path());
    out << "not a checkpoint";
  }
  EXPECT_THROW(simulation.load(file.path()), io::IoError);
  simulation.save(file.path());
  std::filesystem::resize_file(file.path(), std::filesystem::file_size(file.path()) / 2);
  EXPECT_THROW(simulation.load(file.path()), io::IoError) << "cut short";
  Scene other = scene;
  other.bodies.pop_back();
  Simulation(other, 1).save(file.path());
  EXPECT_THROW(simulation.load(file.path()), io::IoError) << "another number of bodies";
}

}  // namespace
}  // namespace repose::mpm
