#include "io/interrupt.hpp"

#include <array>
#include <csignal>
#include <mutex>

namespace repose::io {
namespace {

constexpr std::array signals{SIGINT, SIGTERM, SIGHUP};

volatile std::sig_atomic_t flag = 0;
std::mutex counting;  // a program may have guards on several threads
int guards = 0;       // that live
std::array<struct sigaction, signals.size()> before;

void restore() {
  for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &before[i], nullptr);
}

void note(int signal) {
  flag = signal;
  restore();  // the next one does what it did before
}

}  // namespace

InterruptGuard::InterruptGuard() {
  const std::lock_guard lock(counting);
  if (guards++ > 0) return;
  flag = 0;
  struct sigaction action {};
  action.sa_handler = note;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    sigaction(signals[i], nullptr, &before[i]);
    const bool nohup = signals[i] == SIGHUP && before[i].sa_handler == SIG_IGN;
    if (!nohup) sigaction(signals[i], &action, nullptr);
  }
}

InterruptGuard::~InterruptGuard() {
  const std::lock_guard lock(counting);
  if (--guards == 0) restore();
}

bool InterruptGuard::requested() const { return flag != 0; }

}  // namespace repose::io
