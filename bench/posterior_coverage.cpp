// How often 90 % credible intervals hold the truth: the table of docs/posterior.md.
//
//   posterior_coverage [TWINS [ROUND [KIND…]]]

#include "tests/calibration/posterior_coverage.hpp"

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string_view>

int main(int argc, char** argv) {
  namespace exam = repose::calibration::posterior_exam;
  const int twins = argc > 1 ? std::atoi(argv[1]) : 500, round = argc > 2 ? std::atoi(argv[2]) : 1;
  if (twins < 1 || round < 0 || round > 99) {
    std::fprintf(stderr, "usage: posterior_coverage [TWINS [ROUND [KIND...]]]\n");
    return 2;
  }
  std::printf("%-10s", "kind");
  for (const std::string_view name : repose::calibration::exam::parameter_names)
    std::printf(" | %-14.*s", static_cast<int>(name.size()), name.data());
  std::printf(" | all    | divergent | CPU s\n");
  for (std::size_t k = 0; k < exam::kinds.size(); ++k) {
    bool wanted = argc <= 3;
    for (int i = 3; i < argc; ++i) wanted = wanted || exam::kind_names[k] == argv[i];
    if (!wanted) continue;
    const std::clock_t begin = std::clock();
    const exam::Result r = exam::hold(exam::kinds[k], twins, round);
    std::printf("%-10.*s", static_cast<int>(exam::kind_names[k].size()),
                exam::kind_names[k].data());
    for (std::size_t i = 0; i < 5; ++i)
      std::printf(" | %5.1f %% (%4.2f)", 100.0 * r.share[i], r.width[i]);
    std::printf(" | %5.1f %% | %d | %.0f\n", 100.0 * r.pooled, r.divergent,
                static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    std::fflush(stdout);
  }
  return 0;
}
