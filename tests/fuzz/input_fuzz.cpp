// Any bytes as an input file of any kind: `repose check` accepts them, or refuses them with a place
// and a cause in words of its own, at once and without memory to speak of.
//
// Tables, a law and a scene that a file may name lie beside it (t.csv, h.csv, law.toml,
// scene.toml).
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include "app/commands/check.hpp"
#include "input/input_file.hpp"
#include "io/atomic_file.hpp"
#include "tests/fuzz/input_mutator.hpp"

// there only in a libFuzzer program
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most)
    __attribute__((weak));

namespace {

using namespace repose;
namespace fs = std::filesystem;

#if defined(__SANITIZE_ADDRESS__)
constexpr double most_seconds = 5.0;  // some five times slower than what people run
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
constexpr double most_seconds = 5.0;
#else
constexpr double most_seconds = 1.0;
#endif
#else
constexpr double most_seconds = 1.0;
#endif

/// What no message of ours says: a library's own words.
constexpr std::array<std::string_view, 14> foreign{
    "stod",      "stoi", "stoul",     "basic_string",   "vector::", "std::",    "map::at",
    "bad_alloc", "HDF5", "json.exce", "internal error", "_M_range", "optional", "what():"};

[[noreturn]] void finding(std::string_view what, std::string_view text) {
  std::fprintf(stderr, "FINDING: %.*s: %.*s\n", static_cast<int>(what.size()), what.data(),
               static_cast<int>(text.size()), text.data());
  std::abort();
}

/// A folder of this process, in memory where there is such a thing; gone at its end.
class Folder {
 public:
  Folder() {
    const fs::path base = fs::exists("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
    path_ = base / ("repose_fuzz_" + std::to_string(::getpid()));
    fs::create_directories(path_);
    write("t.csv", "eps_a,q_Pa,u_Pa\n0,0,0\n0.01,1e3,2e2\n0.02,1.5e3,3e2\n0.05,1.8e3,3e2\n");
    write("h.csv",
          "time_s,eps_yy,sigma_xx_Pa,sigma_zz_Pa,eps_xy,eps_yz,eps_zx\n"
          "0,0,1e5,1e5,0,0,0\n1,0.01,1e5,1e5,0,0,0\n2,0.0,1e5,1e5,0,0,0\n");
    write("runs.csv", "initial.ocr,law.M\n1,0.9\n2,1.0\n");
    write("law.toml", "[law]\nname = \"newtonian\"\neta = 1.0\nK = 1e5\nrho_0 = 1e3\n");
    write("scene.toml",
          "[scene]\nend_time = 0.1\n[domain]\nsize = [1.0, 0.5]\n[[body]]\nsize = [0.2, 0.2]\n"
          "law = \"law.toml\"\n[grid]\nh = 0.05\n");
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  std::string file(const char* name) const { return (path_ / name).string(); }
  void write(const char* name, std::string_view text) const {
    const int fd = ::open(file(name).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd < 0 || ::write(fd, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
      finding("cannot write", file(name));
    ::close(fd);
  }

 private:
  fs::path path_;
};

const Folder& folder() {
  static const Folder folder;
  return folder;
}

/// The message says where, in a file, and why, in our words or in those of the file.
void require_sound(const std::string& message, std::string_view file) {
  for (const std::string_view word : foreign)
    if (message.find(word) != std::string::npos && file.find(word) == file.npos)
      finding("a library speaks", message);
  const bool placed =
      message.find(".toml") != std::string::npos || message.find(".csv") != std::string::npos ||
      message.find("--set") != std::string::npos || message.find("chart:1:1") != std::string::npos;
  if (!placed) finding("no place", message);
  if (message.size() < 20) finding("no cause", message);
}

double cpu_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

const fuzz::InputMutator& mutator() {
  static const fuzz::InputMutator mutator;
  return mutator;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  folder().write("f.toml", text);
  app::CommonOptions options;
  options.quiet = true;
  options.threads = 1;
  const double begun = cpu_seconds();
  try {
    if (app::check_file(folder().file("f.toml"), options, app::Looks::count) != io::ExitCode::done)
      finding("neither accepted nor refused", "");
  } catch (const input::BadInput& error) {
    if (error.problems().empty()) finding("refused without a reason", "");
    for (const std::string& problem : error.problems()) require_sound(problem, text);
  } catch (const io::IoError& error) {
    require_sound(error.what(), text);
  } catch (const std::exception& error) {
    finding("internal error", error.what());
  }
  if (cpu_seconds() - begun > most_seconds) finding("too slow", "");
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned int seed) {
  fuzz::Random random(seed);
  std::string text(reinterpret_cast<const char*>(data), size);
  std::string other;
  if (random() % 64 == 0)
    other = mutator().made_up(random() % mutator().kinds(), random);
  else if (random() % 8 != 0)
    other = mutator().changed(text, random);
  if (other.empty() || other.size() > most || other == text) {
    if (LLVMFuzzerMutate != nullptr) return LLVMFuzzerMutate(data, size, most);
    if (size > 0) data[random() % size] = static_cast<std::uint8_t>(random());
    return size;
  }
  std::memcpy(data, other.data(), other.size());
  return other.size();
}
