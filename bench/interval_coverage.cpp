// How often the recommended 95 % intervals hold the truth: the table of docs/fitting.md.
//
//   interval_coverage [TWINS [ROUND [KIND…]]]

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/calibration/coverage.hpp"

int main(int argc, char** argv) {
  namespace exam = repose::calibration::exam;
  const int twins = argc > 1 ? std::atoi(argv[1]) : 500, round = argc > 2 ? std::atoi(argv[2]) : 1;
  if (twins < 1 || round < 0 || round > 99) {
    std::fprintf(stderr, "usage: interval_coverage [TWINS [ROUND [KIND...]]]\n");
    return 2;
  }
  std::printf("%-10s", "kind");
  for (const std::string_view name : exam::parameter_names)
    std::printf(" | %-14.*s", static_cast<int>(name.size()), name.data());
  std::printf(" | all    | s\n");
  for (std::size_t k = 0; k < exam::kinds.size(); ++k) {
    bool wanted = argc <= 3;
    for (int i = 3; i < argc; ++i) wanted = wanted || exam::kind_names[k] == argv[i];
    if (!wanted) continue;
    const auto begin = std::chrono::steady_clock::now();
    const exam::Result r = exam::hold(exam::kinds[k], twins, round);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    std::printf("%-10.*s", static_cast<int>(exam::kind_names[k].size()),
                exam::kind_names[k].data());
    for (std::size_t i = 0; i < 5; ++i)
      std::printf(" | %5.1f %% (%4.2f)", 100.0 * r.share[i], r.width[i]);
    std::printf(" | %5.1f %% | %.0f", 100.0 * r.pooled, seconds);
    std::printf(r.contradictions > 0 ? ", %d contradictions\n" : "\n", r.contradictions);
    std::fflush(stdout);
  }
  return 0;
}
