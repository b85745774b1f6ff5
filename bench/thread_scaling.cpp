/// What a second thread is worth in whole steps of a million points: the column of the paper in
/// the middle of its collapse (mid_collapse.hpp), cubic and relaxed, for mu(I) and Cam-Clay.
///
///   bench_thread_scaling [ROUNDS]
///
/// The two simulations take turns of `turn` steps in one program, so that a drift of the machine's
/// speed falls on both: two runs of bench_mpm after each other scatter with the drift instead.

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include <fmt/core.h>

#include "bench/mid_collapse.hpp"
#include "input/read_scene.hpp"

namespace {

using repose::mpm::MidCollapse;

constexpr int turn = 5;       ///< steps
constexpr int warm_up = 45;   ///< steps of each; the points are sorted every 40 or so
constexpr int division = 22;  ///< 991 232 points

/// Seconds of wall clock.
double time_of(MidCollapse& collapse, int steps) {
  const auto begun = std::chrono::steady_clock::now();
  for (int k = 0; k < steps; ++k) collapse.step();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

void compare(const char* scene_name, int rounds) {
  repose::input::InputFile file = repose::input::InputFile::read(
      fmt::format("{}/data/scenes/{}.toml", REPOSE_SOURCE_DIR, scene_name));
  const repose::mpm::Scene scene = repose::input::read_scene(file).scene;
  const auto with_threads = [&](int threads) {
    return MidCollapse(scene, repose::mpm::Kernel::cubic, repose::mpm::Transfer::relaxed, division,
                       threads);
  };
  MidCollapse one = with_threads(1), two = with_threads(2);
  time_of(one, warm_up);
  time_of(two, warm_up);
  std::vector<double> ratios;
  double one_s = 0.0, two_s = 0.0;
  for (int round = 0; round < rounds; ++round) {
    const double a = time_of(one, turn), b = time_of(two, turn);
    one_s += a;
    two_s += b;
    ratios.push_back(a / b);
  }
  std::sort(ratios.begin(), ratios.end());
  const auto quantile = [&](double share) {
    return ratios[static_cast<std::size_t>(share * static_cast<double>(ratios.size() - 1))];
  };
  const double steps = static_cast<double>(turn) * rounds;
  fmt::print(
      "{}, {} points: {:.1f} ms a step with one thread, {:.1f} with two; ratio {:.2f} of the sums, "
      "{:.2f} median, {:.2f} and {:.2f} quartiles of {} turns\n",
      scene_name, one.points(), 1e3 * one_s / steps, 1e3 * two_s / steps, one_s / two_s,
      quantile(0.5), quantile(0.25), quantile(0.75), rounds);
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 40;
  if (argc > 2 || rounds < 1) {
    fmt::print(stderr, "bench_thread_scaling [ROUNDS], ROUNDS at least 1\n");
    return 2;
  }
  for (const char* scene : {"flat_mu_i", "flat_mcc"}) compare(scene, rounds);
}
