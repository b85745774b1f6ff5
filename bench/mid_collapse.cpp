#include "bench/mid_collapse.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {
namespace {

/// What a step changes, to be put back.
struct Saved {
  std::vector<PointSet> bodies;
  Grid grid;
  Signals signals;
  Ledger ledger;
  double time, last_dt, drift;
  bool must_sort;
  std::int64_t steps, sorts;
};

/// Points of a body by their place in the lattice they were created on.
class Lattice {
 public:
  Lattice(const Scene& scene, const Body& body) : size_(point_lattice(scene, body)) {}
  std::int64_t columns() const { return size_[0]; }
  std::int64_t rows() const { return size_[1]; }
  std::int64_t id(std::int64_t i, std::int64_t j) const { return j * size_[0] + i; }

 private:
  std::array<std::int64_t, 3> size_;
};

}  // namespace

struct MidCollapse::State {
  Simulation simulation;
  std::optional<Saved> saved;

  explicit State(const Scene& scene, int threads) : simulation(scene, threads) {}
};

namespace {

/// The coarse run of a scene at `moment`: its points by id, and the signals of its last step.
struct Coarse {
  PointSet points;                ///< sorted anyhow
  std::vector<std::size_t> slot;  ///< by id
  Signals signals;
};

}  // namespace

/// Runs of the constructor's scenes that are already there.
static std::map<std::string, Coarse>& coarse_runs() {
  static std::map<std::string, Coarse> runs;
  return runs;
}

MidCollapse::MidCollapse(Scene scene, Kernel kernel, Transfer transfer, int division, int threads) {
  scene.h = coarse_h;
  raise_top_to_cells(scene);
  scene.dt.reset();
  scene.courant = 0.4;
  const auto found = coarse_runs().find(scene.name);
  if (found == coarse_runs().end()) {
    Scene first = scene;
    first.kernel = Kernel::cubic;
    first.transfer = Transfer::apic;
    Simulation simulation(first, 1);
    while (simulation.time() < moment) simulation.step(moment);
    Coarse& coarse = coarse_runs()[scene.name];
    coarse.points = simulation.plane_->bodies.at(0);
    coarse.signals = simulation.plane_->signals;
    coarse.slot.resize(coarse.points.count);
    for (std::size_t s = 0; s < coarse.points.slots(); ++s)
      if (coarse.points.id[s] >= 0) coarse.slot[static_cast<std::size_t>(coarse.points.id[s])] = s;
  }
  const Coarse& coarse = coarse_runs().at(scene.name);

  const Lattice parents(scene, scene.bodies.at(0));
  scene.h = coarse_h / division;
  scene.kernel = kernel;
  scene.transfer = transfer;
  now_ = std::make_unique<State>(scene, threads);
  Simulation::Impl<2>& fine = *now_->simulation.plane_;
  const Lattice children(scene, scene.bodies.at(0));
  PointSet& points = fine.bodies.at(0);
  const double spacing = point_spacing(scene);
  const double width = scene.domain[0] * (1.0 - 1e-9), height = scene.domain[1] * (1.0 - 1e-9);
  for (std::size_t s = 0; s < points.slots(); ++s) {
    if (points.id[s] < 0) continue;
    const std::int64_t i = points.id[s] % children.columns();
    const std::int64_t j = points.id[s] / children.columns();
    const std::size_t from =
        coarse.slot[static_cast<std::size_t>(parents.id(i / division, j / division))];
    const PointSet& parent = coarse.points;
    // places within the parent's square, which has grown with its volume
    const double growth = std::sqrt(points[RHO][s] / parent[RHO][from]);
    const auto offset = [&](std::int64_t k) {
      return growth * spacing * (static_cast<double>(k % division) - 0.5 * (division - 1));
    };
    const double dx = offset(i), dy = offset(j);
    points.set(X, s, std::clamp(parent[X][from] + dx, 1e-9, width));
    points.set(Y, s, std::clamp(parent[Y][from] + dy, 1e-9, height));
    points.set(VX, s, parent[VX][from] + parent[LXX][from] * dx + parent[LXY][from] * dy);
    points.set(VY, s, parent[VY][from] + parent[LYX][from] * dx + parent[LYY][from] * dy);
    for (std::size_t f = LXX; f < MASS; ++f) points.set(f, s, parent[f][from]);
    for (std::size_t k = 0; k < points.state_fields(); ++k)
      points.set(STATE + k, s, parent[STATE + k][from]);
    for (std::size_t k = 0; k < affine_fields; ++k)
      points.set(points.affine + k, s, parent[LXX + k][from]);
  }
  fine.signals = coarse.signals;
  fine.must_sort = true;
  for (int k = 0; k < 5; ++k) step();  // fields that belong to the new cells
  now_->saved.emplace(Saved{fine.bodies, fine.grid, fine.signals, fine.ledger, fine.time,
                            fine.last_dt, fine.drift, fine.must_sort, fine.steps, fine.sorts});
}

MidCollapse::~MidCollapse() = default;

void MidCollapse::step() { now_->simulation.step(HUGE_VAL); }

void MidCollapse::restore() {
  Simulation::Impl<2>& s = *now_->simulation.plane_;
  const Saved& saved = *now_->saved;
  s.bodies = saved.bodies;
  s.grid = saved.grid;
  s.signals = saved.signals;
  s.ledger = saved.ledger;
  s.time = saved.time;
  s.last_dt = saved.last_dt;
  s.drift = saved.drift;
  s.must_sort = saved.must_sort;
  s.steps = saved.steps;
  s.sorts = saved.sorts;
}

std::int64_t MidCollapse::points() const { return now_->simulation.point_count(); }
std::int64_t MidCollapse::sorts() const {
  return now_->simulation.counters().sorts - now_->saved->sorts;
}
double MidCollapse::bytes() const { return 1e6 * now_->simulation.counters().memory_MB; }
double MidCollapse::tiles_per_point() const {
  return static_cast<double>(now_->simulation.plane_->grid.point_blocks.size()) /
         static_cast<double>(points());
}
double MidCollapse::node_blocks_per_point() const {
  return static_cast<double>(now_->simulation.plane_->grid.node_blocks.size()) /
         static_cast<double>(points());
}

MidCollapse::Sample MidCollapse::sample(std::size_t most) const {
  const PointSet& points = now_->simulation.plane_->bodies.at(0);
  Sample sample;
  sample.dt = now_->simulation.next_dt();
  const std::size_t stride = std::max<std::size_t>(1, points.slots() / most);
  for (std::size_t s = 0; s < points.slots(); s += stride) {
    if (points.id[s] < 0) continue;
    const auto at = [&](std::size_t f) { return points[f][s]; };
    sample.strain.push_back(
        {sample.dt * at(LXX), sample.dt * at(LYY), 0.0, 0.5 * sample.dt * (at(LXY) + at(LYX))});
    sample.spin.push_back(0.5 * sample.dt * (at(LYX) - at(LXY)));
    sample.stress.push_back({at(SXX), at(SYY), at(SZZ), at(SXY)});
    sample.density.push_back(at(RHO));
    std::vector<double>& state = sample.state.emplace_back();
    for (std::size_t k = 0; k < points.state_fields(); ++k) state.push_back(at(STATE + k));
  }
  return sample;
}

}  // namespace repose::mpm
