/// Measured errors for docs/verification.md, one line per run:
///   verification_tables block|vortex quadratic|cubic TRANSFER N [courant=C] [points=4]
///                       [relaxation_time=S] [end=S] [threads=1]

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/mpm/generalised_vortex.hpp"

namespace {

using namespace repose::mpm;

int usage() {
  std::fputs(
      "usage: verification_tables block|vortex quadratic|cubic TRANSFER N [courant=C] [points=4] "
      "[relaxation_time=S] [end=S] [threads=1]\n",
      stderr);
  return 2;
}

}  // namespace

int main(int count, char** arguments) try {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  if (words.size() < 4) return usage();
  const bool vortex = words[0] == "vortex";
  const auto named = std::find(transfer_names.begin(), transfer_names.end(), words[2]);
  const int n = std::atoi(words[3].c_str());
  if ((!vortex && words[0] != "block") || (words[1] != "cubic" && words[1] != "quadratic") ||
      named == transfer_names.end() || n < 4)
    return usage();
  const Kernel kernel = words[1] == "cubic" ? Kernel::cubic : Kernel::quadratic;
  const auto transfer = static_cast<Transfer>(named - transfer_names.begin());
  const ManufacturedBlock block_problem;
  const GeneralisedVortex vortex_problem;
  Scene scene =
      vortex ? vortex_problem.scene(n, kernel, transfer) : block_problem.scene(n, kernel, transfer);
  double end = vortex ? 1.0 : 0.02;
  int threads = 1;
  for (std::size_t k = 4; k < words.size(); ++k) {
    const std::size_t equals = words[k].find('=');
    if (equals == std::string::npos) return usage();
    const std::string key = words[k].substr(0, equals);
    const double value = std::atof(words[k].c_str() + equals + 1);
    if (key == "courant")
      scene.courant = value;
    else if (key == "points")
      scene.points_per_cell = static_cast<int>(value);
    else if (key == "relaxation_time")
      scene.relaxation_time = value;
    else if (key == "end")
      end = value;
    else if (key == "threads")
      threads = static_cast<int>(value);
    else
      return usage();
  }
  const auto before = std::chrono::steady_clock::now();
  const auto errors = vortex ? vortex_problem.run(scene, end, 40, threads)
                             : block_problem.run(scene, end, 40, threads);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - before;
  for (const std::string& word : words) std::printf("%s ", word.c_str());
  std::printf(
      "| rms (largest): displacement %.5f (%.5f), velocity %.5f (%.5f), stress %.5f (%.5f)"
      " | %lld steps, %.1f s\n",
      errors.displacement.rms, errors.displacement.largest, errors.velocity.rms,
      errors.velocity.largest, errors.stress.rms, errors.stress.largest,
      static_cast<long long>(errors.steps), took.count());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "verification_tables: %s\n", error.what());
  return 3;
}
