/// \file
/// Whole steps of the Material Point Method on the column of the paper, in the middle of its
/// collapse: point-steps per second for every law, kernel, transfer, number of points and threads,
/// beside what the machine can do (peak/…, triad/…). Shares are of one core's measured peak and of
/// the bandwidth of a triad as large as points and grid, times the threads; operations and
/// bytes are counted (mpm_cost.hpp).
///   build/bench/bin/bench_mpm --benchmark_filter='mu_i_stiff/cubic/apic'
///   scripts/bench

#include <map>

#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include "bench/mid_collapse.hpp"
#include "bench/mpm_cost.hpp"
#include "bench/roofline.hpp"
#include "input/read_scene.hpp"

namespace repose::bench {
namespace {

using benchmark::Counter;
using mpm::MidCollapse;

/// A law of the paper's flat column, by its scene in data/scenes.
struct LawCase {
  std::string_view name, scene;
};
constexpr std::array laws{LawCase{"mu_i_stiff", "flat_mu_i"},
                          LawCase{"mu_i_soft", "flat_mu_i_soft"}, LawCase{"cam_clay", "flat_mcc"},
                          LawCase{"newtonian", "flat_newtonian"}};

/// 2 048 points of the coarse run times division²: 2 k, 8 k, 74 k, 1 M.
constexpr std::array divisions{1, 2, 6, 22};

const mpm::Scene& scene_of(const LawCase& law) {
  static std::map<std::string_view, mpm::Scene> scenes;
  const auto found = scenes.find(law.name);
  if (found != scenes.end()) return found->second;
  input::InputFile file =
      input::InputFile::read(fmt::format("{}/data/scenes/{}.toml", REPOSE_SOURCE_DIR, law.scene));
  return scenes.emplace(law.name, input::read_scene(file).scene).first->second;
}

void whole_steps(benchmark::State& timing, const LawCase* law, mpm::Kernel kernel,
                 mpm::Transfer transfer, int division, int threads) {
  MidCollapse collapse(scene_of(*law), kernel, transfer, division, threads);
  // with soft laws the points are sorted once or more on the way, with stiff ones not at all
  constexpr int steps = 40;
  std::int64_t sorts = 0;
  for (auto _ : timing) {
    timing.PauseTiming();
    collapse.restore();
    timing.ResumeTiming();
    for (int k = 0; k < steps; ++k) collapse.step();
    timing.PauseTiming();
    sorts += collapse.sorts();
    timing.ResumeTiming();
  }
  const auto points = static_cast<double>(collapse.points());
  const double done = points * steps * static_cast<double>(timing.iterations());
  const auto rate = [&](double each) { return Counter(each * done, Counter::kIsRate); };
  timing.counters["point_steps/s"] = rate(1.0);
  timing.counters["per_core"] = rate(1.0 / threads);
  timing.counters["bytes/point"] = collapse.bytes() / points;
  timing.counters["sorts/step"] =
      static_cast<double>(sorts) / (steps * static_cast<double>(timing.iterations()));

  const mpm::Scene& scene = scene_of(*law);
  const LawSpec& spec = scene.bodies.at(0).law;
  const LawInfo& info = find_law(spec);
  const auto work = transfer_work(kernel, transfer, info.state.size(), !info.has_stress_memory,
                                  collapse.tiles_per_point(), collapse.node_blocks_per_point());
  if (!work) return;
  const double flops = work->flops + law_flops(spec, collapse.sample(2000));
  const double bandwidth = triad_bandwidth(collapse.bytes() / threads);
  timing.counters["flops"] = flops;
  timing.counters["bytes"] = work->bytes;
  timing.counters["of_peak"] = rate(flops / (peak_flops() * threads));
  timing.counters["of_bandwidth"] = rate(work->bytes / (bandwidth * threads));
}

void peak(benchmark::State& timing, std::size_t width) {
  double best = 0.0;
  for (auto _ : timing) best = std::max(best, peak_flops(width));
  timing.counters["flop/s"] = best;
}

void triad(benchmark::State& timing, double bytes) {
  for (auto _ : timing) timing.counters["bytes/s"] = triad_bandwidth(bytes);
}

const bool registered = [] {
  for (const std::size_t width : register_widths())
    benchmark::RegisterBenchmark(fmt::format("peak/fma_{}", 64 * width).c_str(), peak, width)
        ->Unit(benchmark::kMillisecond)
        ->Iterations(3);
  // within the second-level cache of one core, the shared cache, and memory
  for (const auto& [name, bytes] :
       {std::pair{"512KiB", 524288.0}, {"8MiB", 8388608.0}, {"512MiB", 536870912.0}})
    benchmark::RegisterBenchmark(fmt::format("triad/{}", name).c_str(), triad, bytes)
        ->Unit(benchmark::kMillisecond)
        ->Iterations(1);
  for (const int division : divisions)
    for (const LawCase& law : laws)
      for (const mpm::Kernel kernel : {mpm::Kernel::cubic, mpm::Kernel::quadratic})
        for (std::size_t t = 0; t < mpm::transfer_names.size(); ++t)
          for (const int threads : {1, 2}) {
            const std::string name =
                fmt::format("{}/{}/{}/{}/threads:{}", law.name, mpm::name_of(kernel),
                            mpm::transfer_names[t], 2048 * division * division, threads);
            auto* one =
                benchmark::RegisterBenchmark(name.c_str(), whole_steps, &law, kernel,
                                             static_cast<mpm::Transfer>(t), division, threads);
            one->Unit(benchmark::kMillisecond);
            // one thread: CPU time, which other programs do not lengthen; two: that they overlap
            // is the point
            if (threads == 1)
              one->MeasureProcessCPUTime();
            else
              one->UseRealTime();
          }
  return true;
}();

}  // namespace
}  // namespace repose::bench
