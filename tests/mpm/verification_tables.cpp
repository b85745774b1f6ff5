/// Measured errors for docs/verification.md, a few lines per run:
///   verification_tables block|vortex|bar|ritter|column quadratic|cubic TRANSFER N [courant=C]
///       [points=4] [relaxation_time=S] [order=M] [end=S] [no_slip=1] [curve=1] [threads=1]
/// curve=1 (ritter, column): the profile at the end, or the front over time, to be drawn instead.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/mpm/dam_break.hpp"
#include "tests/mpm/generalised_vortex.hpp"
#include "tests/mpm/standing_wave.hpp"

namespace {

using namespace repose::mpm;

constexpr const char* usage =
    "usage: verification_tables block|vortex|bar|ritter|column quadratic|cubic TRANSFER N "
    "[courant=C] [points=4] [relaxation_time=S] [order=M] [end=S] [no_slip=1] [curve=1] "
    "[threads=1]\n";

struct Options {
  std::string problem;
  Kernel kernel = Kernel::cubic;
  Transfer transfer = Transfer::apic;
  int n = 0;
  std::vector<std::pair<std::string, double>> given;

  double value(const std::string& key, double otherwise) const {
    for (const auto& [name, x] : given)
      if (name == key) return x;
    return otherwise;
  }
  int threads() const { return static_cast<int>(value("threads", 1)); }
  void apply(Scene& scene) const {
    scene.kernel = kernel;
    scene.transfer = transfer;
    scene.courant = value("courant", scene.courant);
    scene.points_per_cell = static_cast<int>(value("points", 4));
    scene.order = static_cast<int>(value("order", scene.order));
    if (const double tau = value("relaxation_time", 0.0); tau > 0.0) scene.relaxation_time = tau;
  }
};

bool read(const std::vector<std::string>& words, Options& options) {
  if (words.size() < 4) return false;
  const auto named = std::find(transfer_names.begin(), transfer_names.end(), words[2]);
  if ((words[1] != "cubic" && words[1] != "quadratic") || named == transfer_names.end())
    return false;
  options.problem = words[0];
  options.kernel = words[1] == "cubic" ? Kernel::cubic : Kernel::quadratic;
  options.transfer = static_cast<Transfer>(named - transfer_names.begin());
  options.n = std::atoi(words[3].c_str());
  for (std::size_t k = 4; k < words.size(); ++k) {
    const std::size_t equals = words[k].find('=');
    if (equals == std::string::npos) return false;
    options.given.emplace_back(words[k].substr(0, equals), std::atof(&words[k][equals + 1]));
    constexpr std::array<std::string_view, 8> known{
        "courant", "points", "relaxation_time", "order", "end", "no_slip", "curve", "threads"};
    if (std::find(known.begin(), known.end(), options.given.back().first) == known.end())
      return false;
  }
  return options.n >= 4;
}

void print(const ManufacturedBlock::Errors& errors) {
  std::printf(
      "rms (largest): displacement %.5f (%.5f), velocity %.5f (%.5f), stress %.5f (%.5f), %lld "
      "steps\n",
      errors.displacement.rms, errors.displacement.largest, errors.velocity.rms,
      errors.velocity.largest, errors.stress.rms, errors.stress.largest,
      static_cast<long long>(errors.steps));
}

void block(const Options& options) {
  const ManufacturedBlock problem;
  Scene scene = problem.scene(options.n, options.kernel, options.transfer);
  options.apply(scene);
  print(problem.run(scene, options.value("end", 0.02), 40, options.threads()));
}

void vortex(const Options& options) {
  const GeneralisedVortex problem;
  Scene scene = problem.scene(options.n, options.kernel, options.transfer);
  options.apply(scene);
  print(problem.run(scene, options.value("end", 1.0), 40, options.threads()));
}

/// n cells over the length; `end`: periods.
void bar(const Options& options) {
  const StandingWave wave;
  Scene scene =
      wave.scene(options.n, options.kernel, options.transfer, options.value("courant", 0.4));
  options.apply(scene);
  if (scene.transfer == Transfer::relaxed && !scene.relaxation_time)
    scene.relaxation_time = 0.02 * wave.period();
  const double periods = options.value("end", 5.2);
  const StandingWave::Swing found = wave.run(scene, periods, options.threads());
  const StandingWave::Swing map = wave.predicted(scene, periods);
  std::printf("frequency %+.3e (map of the mode %+.3e), decrement per period %.3e (%.3e)\n",
              found.omega / wave.omega() - 1.0, map.omega / wave.omega() - 1.0, found.decrement,
              map.decrement);
}

/// n cells over the depth of a reservoir 9 H long; `end` in √(H/g).
void ritter(const Options& options) {
  const double end = options.value("end", 8.0);
  const DamBreak dam = long_reservoir(end);
  Scene scene =
      dam.scene(dam.H / options.n,
                options.value("no_slip", 0.0) > 0.0 ? Wall::Kind::no_slip : Wall::Kind::slip);
  options.apply(scene);
  Simulation simulation(scene, options.threads());
  if (options.value("curve", 0.0) > 0.0) {
    const double t = end * std::sqrt(dam.H / dam.g);
    run_until(simulation, t);
    const Simulation::Profile profile = simulation.profile();
    for (std::size_t i = 0; i < profile.x_m.size(); ++i) {
      const double x = profile.x_m[i] - dam.W;
      std::printf("%g %g %g\n", x / (std::sqrt(dam.g * dam.H) * t), profile.depth_m[i] / dam.H,
                  ritter_depth(dam.H, dam.g, x, t) / dam.H);
    }
    return;
  }
  std::printf("\n  t/sqrt(H/g)  rms depth/H  at the dam (4/9)  front/c_0 t  99 %% front/c_0 t\n");
  const double unit = std::sqrt(dam.H / dam.g), c_0 = std::sqrt(dam.g * dam.H);
  for (const double T : {1.0, 2.0, 4.0, 8.0}) {
    if (T > end) break;
    run_until(simulation, T * unit);
    const RitterError error = ritter_error(simulation, dam);
    const SeriesRow row = simulation.diagnostics();
    std::printf("  %-11g  %-11.4f  %-16.4f  %-11.3f  %.3f\n", T, error.rms, error.at_dam,
                (row.front_m - dam.W) / (c_0 * T * unit),
                (row.front_99_m - dam.W) / (c_0 * T * unit));
  }
}

/// The column of Martin & Moyce, n cells over its width.
void column(const Options& options) {
  const DamBreak dam;
  Scene scene =
      dam.scene(dam.W / options.n,
                options.value("no_slip", 0.0) > 0.0 ? Wall::Kind::no_slip : Wall::Kind::slip);
  options.apply(scene);
  Simulation simulation(scene, options.threads());
  if (options.value("curve", 0.0) > 0.0) {
    for (int k = 0; k <= 100; ++k) {
      const double T = 0.045 * k;
      run_until(simulation, T / std::sqrt(2.0 * dam.g / dam.W));
      std::printf("%g %g\n", T, simulation.diagnostics().front_m / dam.W);
    }
    return;
  }
  std::printf("\n  t sqrt(2g/W)  measured x/W  front  tip   99 %% front\n");
  double sum = 0.0;
  const auto rows = two_columns(REPOSE_SOURCE_DIR "/data/experiments/dam_break_martin_moyce.csv");
  for (const auto& [T, x] : rows) {
    run_until(simulation, T / std::sqrt(2.0 * dam.g / dam.W));
    const SeriesRow row = simulation.diagnostics();
    sum += std::pow(row.front_m / dam.W - x, 2);
    std::printf("  %-12g  %-12.2f  %.2f   %.2f  %.2f\n", T, x, row.front_m / dam.W,
                row.front_max_m / dam.W, row.front_99_m / dam.W);
  }
  std::printf("  rms distance of the front from the measured one: %.3f W\n",
              std::sqrt(sum / static_cast<double>(rows.size())));
}

}  // namespace

int main(int count, char** arguments) try {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  constexpr std::array<std::pair<std::string_view, void (*)(const Options&)>, 5> problems{
      {{"block", block}, {"vortex", vortex}, {"bar", bar}, {"ritter", ritter}, {"column", column}}};
  Options options;
  const auto problem = std::find_if(problems.begin(), problems.end(), [&](const auto& p) {
    return !words.empty() && p.first == words[0];
  });
  if (problem == problems.end() || !read(words, options)) {
    std::fputs(usage, stderr);
    return 2;
  }
  const bool curve = options.value("curve", 0.0) > 0.0;
  if (!curve) {
    for (const std::string& word : words) std::printf("%s ", word.c_str());
    std::printf("| ");
  }
  std::fflush(stdout);
  const auto before = std::chrono::steady_clock::now();
  problem->second(options);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
  if (!curve) std::printf("  %.2f s\n", took.count());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "verification_tables: %s\n", error.what());
  return 3;
}
