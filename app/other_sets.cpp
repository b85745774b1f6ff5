#include "app/other_sets.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>
#include <unistd.h>

#include "models/instruction_set.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;

/// The folder of the program that is running.
fs::path own_folder() {
  std::error_code none;
  return fs::read_symlink("/proc/self/exe", none).parent_path();
}

/// PREFIX/lib/repose/LEVEL/repose, of the program in PREFIX/bin.
fs::path program_for(const InstructionSet& set) {
  return own_folder().parent_path() / "lib" / "repose" / set.level / "repose";
}

/// One that has been handed over to lies in lib/repose itself.
bool is_one_of_several() { return own_folder().parent_path().filename() == "repose"; }

bool installed(const InstructionSet& set) { return access(program_for(set).c_str(), X_OK) == 0; }

/// The name after --instruction-set, taken out of the arguments.
std::string asked_for(int& argc, char** argv) {
  constexpr std::string_view option = "--instruction-set";
  if (argc < 2) return "";
  const std::string_view first = argv[1];
  int taken = 0;
  std::string name;
  if (first == option && argc > 2) {
    name = argv[2];
    taken = 2;
  } else if (first.starts_with(std::string(option) + "=")) {
    name = first.substr(option.size() + 1);
    taken = 1;
  }
  if (taken > 0) {
    std::copy(argv + 1 + taken, argv + argc + 1, argv + 1);  // with the null at their end
    argc -= taken;
  }
  return name;
}

}  // namespace

std::vector<InstructionSet> instruction_sets() {
#if defined(__x86_64__)
  const bool v4 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                  __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                  __builtin_cpu_supports("avx512vl");
  const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return {{"avx512", "x86-64-v4", v4}, {"avx2", "x86-64-v3", v3}};
#elif defined(__aarch64__)
  return {{"neon", "armv8-a", true}};  // every one of these processors has it
#else
  return {};
#endif
}

std::string hand_over(int& argc, char** argv) {
  const std::string wanted = asked_for(argc, argv);
  if (is_one_of_several()) return "";
  std::string here;
  for (const InstructionSet& set : instruction_sets()) {
    const bool own = set.name == instruction_set();
    if (!set.here || !(own || installed(set))) continue;
    here += (here.empty() ? "" : ", ") + std::string(set.name);
    if (!wanted.empty() && wanted != set.name) continue;
    if (own) return "";
    execv(program_for(set).c_str(), argv);  // returns where that failed: this one can do it too
    if (wanted.empty()) return "";
    return fmt::format("--instruction-set {}: {} cannot be started", wanted,
                       program_for(set).string());
  }
  if (wanted.empty()) return "";
  return fmt::format("--instruction-set {}: this installation and machine have {}", wanted,
                     here.empty() ? std::string(instruction_set()) : here);
}

}  // namespace repose::app
