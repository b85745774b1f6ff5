#include "umat/in/host_process.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <new>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "umat/in/futex.hpp"
#include "umat/in/installation.hpp"

extern char** environ;

namespace repose::umat {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr long look_ms = 20;  ///< how often a process that says nothing is looked at

std::string signal_name(int signal) {
  const char* const name = ::sigabbrev_np(signal);
  const char* const what = ::sigdescr_np(signal);
  return name == nullptr ? fmt::format("signal {}", signal) : fmt::format("SIG{}, {}", name, what);
}

/// A call that does nothing but wait may do so for this many times the limit of its own time.
constexpr double most_waiting = 10.0;

/// CPU time of a process [s]; 0 where it cannot be had.
double cpu_time(pid_t pid) {
  clockid_t clock{};
  timespec now{};
  if (::clock_getcpuclockid(pid, &clock) != 0 || ::clock_gettime(clock, &now) != 0) return 0.0;
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A descriptor that is closed at the end of the scope.
struct Descriptor {
  int fd = -1;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

}  // namespace

std::string_view word(Fault fault) {
  switch (fault) {
    case Fault::none:
      break;
    case Fault::not_loaded:
      return "umat_not_loaded";
    case Fault::no_symbol:
      return "umat_no_symbol";
    case Fault::crashed:
      return "umat_crashed";
    case Fault::aborted:
      return "umat_aborted";
    case Fault::beyond_array:
      return "umat_beyond_array";
    case Fault::exited:
      return "umat_exited";
    case Fault::too_long:
      return "umat_too_long";
    case Fault::killed:
      return "umat_killed";
    case Fault::not_finite:
      return "umat_not_finite";
    case Fault::not_converged:
      return "umat_not_converged";
    case Fault::no_host:
      return "umat_no_host";
  }
  return "umat_failed";
}

fs::path host_program() {
  if (const char* const named = std::getenv("REPOSE_UMAT_HOST")) {
    if (::access(named, X_OK) == 0) return named;
    throw Failure(Fault::no_host, 0,
                  fmt::format("REPOSE_UMAT_HOST = {} is no program that can be run", named));
  }
  const std::vector<fs::path> all = places("repose-umat-host", "libexec/repose/repose-umat-host");
  for (const fs::path& place : all)
    if (::access(place.c_str(), X_OK) == 0) return place;
  throw Failure(
      Fault::no_host, 0,
      fmt::format("the program that runs foreign laws, repose-umat-host, is neither beside "
                  "this one nor at {} (the environment variable REPOSE_UMAT_HOST may name "
                  "it)",
                  all[2].string()));
}

HostProcess::HostProcess(const Library& library) : library_(library) {
  const fs::path program = host_program();
  const auto no_start = [&](const char* what) {
    const std::string text =
        fmt::format("{}: {}: {}", program.string(), what, std::strerror(errno));
    end();
    throw Failure(Fault::no_host, 0, text);
  };
  bytes_ = shared_bytes(library.nprops, library.nstatv);
  Descriptor shared{::memfd_create("repose-umat", MFD_CLOEXEC)};
  if (shared.fd < 0 || ::ftruncate(shared.fd, static_cast<off_t>(bytes_)) != 0)
    no_start("no shared memory");
  log_ = ::memfd_create("repose-umat-log", MFD_CLOEXEC);
  if (log_ < 0 || ::fcntl(log_, F_SETFL, O_APPEND) != 0) no_start("no memory for its output");
  memory_ = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED, shared.fd, 0);
  if (memory_ == MAP_FAILED) {
    memory_ = nullptr;
    no_start("no shared memory");
  }
  exchange_ = Exchange(memory_);
  Header& header = *new (memory_) Header{};
  header.nprops = static_cast<std::uint32_t>(library.nprops);
  header.nstatv = static_cast<std::uint32_t>(library.nstatv);
  header.time_limit_s = static_cast<std::uint32_t>(std::ceil(library.time_limit_s));
  header.parent = static_cast<std::uint32_t>(::getpid());

  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawnattr_init(&attributes);
  // descriptors of its own and no other; a group of its own, so that Ctrl-C is repose's business
  ::posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&files, log_, 1);
  ::posix_spawn_file_actions_adddup2(&files, log_, 2);
  ::posix_spawn_file_actions_adddup2(&files, shared.fd, 3);
  ::posix_spawn_file_actions_addclosefrom_np(&files, 4);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  ::posix_spawnattr_setpgroup(&attributes, 0);
  sigset_t none;
  ::sigemptyset(&none);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  std::array<std::string, 5> words{program.string(), "3", library.file.string(), library.symbol,
                                   library.cmname};
  std::array<char*, 6> arguments{};
  for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
  const int error =
      ::posix_spawn(&pid_, words[0].c_str(), &files, &attributes, arguments.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&files);
  if (error != 0) {
    pid_ = -1;
    errno = error;
    no_start("it does not start");
  }
  try {
    await(1);
  } catch (...) {
    end();
    throw;
  }
}

HostProcess::~HostProcess() { end(); }

void HostProcess::end() {
  if (pid_ > 0) {
    ::kill(-pid_, SIGKILL);  // its group, with what the library may have started
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
  }
  if (memory_ != nullptr) ::munmap(memory_, bytes_);
  memory_ = nullptr;
  if (log_ >= 0) ::close(log_);
  log_ = -1;
}

void HostProcess::run(std::size_t count, std::size_t ntens, bool subdivide) {
  Header& header = exchange_.header();
  header.count = static_cast<std::uint32_t>(count);
  header.ntens = static_cast<std::uint32_t>(ntens);
  header.subdivide = subdivide ? 1 : 0;
  header.at.store(0, std::memory_order_relaxed);
  header.calls.store(0, std::memory_order_relaxed);
  const std::uint32_t request = header.request.load(std::memory_order_relaxed) + 1;
  await(request);
  check_finite(count, ntens);
}

void HostProcess::await(std::uint32_t request) {
  Header& header = exchange_.header();
  header.request.store(request, std::memory_order_release);
  wake(header.request);
  Clock::time_point since = Clock::now();
  std::uint32_t calls = 0;
  double cpu_since = -1.0;
  for (;;) {
    const std::uint32_t answer = header.answer.load(std::memory_order_acquire);
    if (answer == request) break;
    wait_for_change(header.answer, answer, look_ms);
    if (header.answer.load(std::memory_order_acquire) == request) break;
    int status = 0;
    const pid_t gone = ::waitpid(pid_, &status, WNOHANG);
    if (gone == pid_) {
      if (header.answer.load(std::memory_order_acquire) == request) {
        pid_ = -1;
        break;  // it has left word before it ended
      }
      pid_ = -1;
      const std::size_t point = header.at.load(std::memory_order_relaxed);
      if (WIFSIGNALED(status))
        fail(Fault::killed, point,
             fmt::format("its process was ended by {}", signal_name(WTERMSIG(status))));
      fail(Fault::exited, point,
           fmt::format("it ended its process with exit code {} (_exit, _Exit)",
                       WEXITSTATUS(status)));
    }
    const double cpu = cpu_time(pid_);
    if (const std::uint32_t now = header.calls.load(std::memory_order_acquire);
        now != calls || cpu_since < 0.0) {
      calls = now;
      since = Clock::now();
      cpu_since = cpu;
    }
    // by its own time, so that a busy machine fails nobody; and by the clock, for one that sleeps
    const double waited = std::chrono::duration<double>(Clock::now() - since).count();
    if (cpu - cpu_since > library_.time_limit_s || waited > most_waiting * library_.time_limit_s)
      fail(Fault::too_long, header.at.load(std::memory_order_relaxed),
           request == 1 ? fmt::format("it took more than {:g} s to load", library_.time_limit_s)
                        : fmt::format("a call took more than {:g} s (time_limit): an endless loop?",
                                      library_.time_limit_s));
  }
  if (header.fault != static_cast<std::uint32_t>(Fault::none)) fail();
}

void HostProcess::fail() {
  const Header& header = exchange_.header();
  const auto fault = static_cast<Fault>(header.fault);
  const std::size_t point = header.at.load(std::memory_order_relaxed);
  const std::string message(header.message, ::strnlen(header.message, sizeof header.message));
  // what it prints while it ends is worth waiting for
  for (int i = 0; i < 50 && pid_ > 0; ++i) {
    if (::waitpid(pid_, nullptr, WNOHANG) == pid_) pid_ = -1;
    if (pid_ > 0) ::usleep(10'000);
  }
  std::string what;
  switch (fault) {
    case Fault::not_loaded:
      what = fmt::format("it cannot be loaded: {}", message);
      break;
    case Fault::no_symbol:
      what = fmt::format("it has no function {}{}", library_.symbol,
                         message.empty() ? ", and none whose name contains \"umat\""
                                         : fmt::format(" (symbol); it has {}", message));
      break;
    case Fault::crashed:
      what = fmt::format("it crashed ({})", signal_name(header.detail));
      break;
    case Fault::aborted:
      what = "it called abort()";
      break;
    case Fault::beyond_array:
      what = fmt::format("it reads or writes beyond {} (NPROPS = {}, NSTATV = {}, NTENS = {})",
                         message, header.nprops, header.nstatv, header.ntens);
      break;
    case Fault::exited:
      what = fmt::format("it ended its process with exit code {} (STOP, exit)", header.detail);
      break;
    case Fault::not_converged:
      what = "it asked for ever smaller increments (PNEWDT < 1), down to a millionth of the whole";
      break;
    default:
      what = "its process answered with an unknown fault";
      break;
  }
  fail(fault, point, what);
}

void HostProcess::fail(Fault fault, std::size_t point, const std::string& what) {
  const std::string text = fmt::format("{}: {}{}", library_.file.string(), what, printed());
  if (fault != Fault::not_finite) end();
  throw Failure(fault, point, text);
}

std::string HostProcess::printed() const {
  constexpr off_t most = 400;
  if (log_ < 0) return "";
  const off_t size = ::lseek(log_, 0, SEEK_END);
  if (size <= 0) return "";
  std::vector<char> tail(static_cast<std::size_t>(std::min(size, most)));
  const ssize_t got = ::pread(log_, tail.data(), tail.size(), std::max<off_t>(0, size - most));
  std::string text;
  for (ssize_t i = 0; i < got; ++i) {
    const char c = tail[static_cast<std::size_t>(i)];
    const bool space = c == '\n' || c == '\t' || c == ' ' || c == '\r';
    if (space && (text.empty() || text.back() == ' ')) continue;
    text += space ? ' ' : static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text.empty() ? "" : fmt::format("; it printed \"{}{}\"", size > most ? "… " : "", text);
}

void HostProcess::check_finite(std::size_t count, std::size_t ntens) {
  for (std::size_t i = 0; i < count; ++i) {
    const PointRecord& record = exchange_.point(i);
    if (record.pnewdt < 1.0) continue;  // not a result
    const auto check = [&](const char* name, const double* values, std::size_t n) {
      for (std::size_t k = 0; k < n; ++k)
        if (!std::isfinite(values[k]))
          fail(Fault::not_finite, i,
               fmt::format("it returned {}({}) = {}", name, k + 1, values[k]));
    };
    check("STRESS", record.stress, ntens);
    check("STATEV", exchange_.statev(i), exchange_.header().nstatv);
    for (std::size_t column = 0; column < ntens; ++column)
      for (std::size_t row = 0; row < ntens; ++row)
        if (const double x = record.ddsdde[column * ntens + row]; !std::isfinite(x))
          fail(Fault::not_finite, i,
               fmt::format("it returned DDSDDE({},{}) = {}", row + 1, column + 1, x));
    for (const auto& [name, x] : {std::pair{"SSE", record.sse}, std::pair{"SPD + SCD", record.spd},
                                  std::pair{"PNEWDT", record.pnewdt}})
      if (!std::isfinite(x))
        fail(Fault::not_finite, i, fmt::format("it returned {} = {}", name, x));
  }
}

}  // namespace repose::umat
