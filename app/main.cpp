#include <cstdio>

#include "app/command_line.hpp"
#include "app/other_sets.hpp"
#include "io/exit_code.hpp"

int main(int argc, char** argv) {
  if (const std::string problem = repose::app::hand_over(argc, argv); !problem.empty()) {
    std::fprintf(stderr, "repose: %s\n", problem.c_str());
    return static_cast<int>(repose::io::ExitCode::bad_input);
  }
  return repose::app::run_command_line(argc, argv);
}
