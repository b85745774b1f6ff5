/// repose-umat-host: the process in which a foreign UMAT runs, so that nothing it does can harm
/// repose. Started by repose alone: FD LIBRARY SYMBOL CMNAME, where FD is the shared memory
/// (wire.hpp).
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <thread>

#include <dlfcn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "umat/in/futex.hpp"
#include "umat/in/host/symbols.hpp"
#include "umat/in/host/umat_call.hpp"

namespace repose::umat {
namespace {

// what a signal handler needs
Header* shared = nullptr;
std::uint32_t request = 0;
const UmatCall* current = nullptr;
const pid_t self = ::getpid();

void say(const char* text) {
  std::strncpy(shared->message, text, sizeof shared->message - 1);
  shared->message[sizeof shared->message - 1] = '\0';
}

void answer() {
  shared->answer.store(request, std::memory_order_release);
  wake(shared->answer);
}

/// A library may fork; what becomes of the child is not what becomes of this process
/// (umat_call.cpp has those that return).
void leave_if_a_child() {
  if (::getpid() != self) ::_exit(0);
}

void give_up(Fault fault, int detail) {
  shared->fault = static_cast<std::uint32_t>(fault);
  shared->detail = detail;
  answer();
}

/// A signal ends the process; what it was and which array it was about is left behind.
void on_signal(int signal, siginfo_t* info, void*) {
  leave_if_a_child();
  Fault fault = signal == SIGABRT ? Fault::aborted : Fault::crashed;
  shared->message[0] = '\0';
  if (signal == SIGSEGV && current != nullptr)
    if (const GuardedArray* array = current->guarding(info->si_addr)) {
      fault = Fault::beyond_array;
      say(array->name());
      if (!array->is_behind(info->si_addr)) {
        std::strncat(shared->message, ", before its beginning", 40);
      } else {
        std::strncat(shared->message, ", behind its end", 40);
      }
    }
  give_up(fault, signal);
  ::_exit(70);
}

/// STOP and exit() come here.
void on_end(int status, void*) {
  leave_if_a_child();
  shared->message[0] = '\0';
  give_up(Fault::exited, status);
}

void catch_signals() {
  static std::array<char, 65536> stack;  // the UMAT's own may be what has run out
  stack_t other{};
  other.ss_sp = stack.data();
  other.ss_size = stack.size();
  ::sigaltstack(&other, nullptr);
  struct sigaction action {};
  action.sa_sigaction = on_signal;
  action.sa_flags = static_cast<int>(SA_SIGINFO | SA_ONSTACK | SA_RESETHAND);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXFSZ, SIGSYS})
    ::sigaction(signal, &action, nullptr);
}

/// What a UMAT prints goes to a file in memory of which only the end matters.
void keep_log_short() {
  struct stat log {};
  if (::fstat(1, &log) == 0 && log.st_size > 65536) {
    std::fflush(nullptr);
    if (::ftruncate(1, 0) != 0) return;
  }
}

/// Ends this process and what the library has started when repose is there no more, whatever the
/// library is doing.
void end_with_repose() {
  sigset_t all;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_BLOCK, &all, nullptr);
  for (;;) {
    ::usleep(500'000);
    if (static_cast<std::uint32_t>(::getppid()) == shared->parent) continue;
    if (::getpgrp() == self) ::kill(0, SIGKILL);
    ::raise(SIGKILL);
  }
}

UmatFunction* load(const char* library, const char* symbol) {
  void* const handle = ::dlopen(library, RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* const why = ::dlerror();
    say(why == nullptr ? "dlopen failed" : why);
    give_up(Fault::not_loaded, 0);
    return nullptr;
  }
  void* const found = ::dlsym(handle, symbol);
  if (found == nullptr) {
    std::string alike;
    for (const std::string& name : similar_symbols(exported_functions(library), symbol))
      alike += (alike.empty() ? "" : ", ") + name;
    say(alike.c_str());
    give_up(Fault::no_symbol, 0);
    return nullptr;
  }
  return reinterpret_cast<UmatFunction*>(found);
}

/// Waits for the next request; false when nobody is there any more to ask.
bool next_request() {
  while (shared->request.load(std::memory_order_acquire) == request) {
    wait_for_change(shared->request, request, 500);
    if (static_cast<std::uint32_t>(::getppid()) != shared->parent) return false;
  }
  ++request;
  return true;
}

int serve(const Exchange& exchange, const char* library, const char* symbol, const char* cmname) {
  if (!next_request()) return 0;
  UmatFunction* const function = load(library, symbol);
  if (function == nullptr) return 1;
  std::unique_ptr<UmatCall> of_ntens[2];
  answer();
  while (next_request()) {
    Header& header = *shared;
    std::unique_ptr<UmatCall>& call = of_ntens[header.ntens == 4 ? 0 : 1];
    if (!call) call = std::make_unique<UmatCall>(function, header, cmname);
    current = call.get();
    // nobody may be left to end an endless loop
    ::alarm(10 * (header.time_limit_s + 1) * (header.count + 1));
    for (std::uint32_t i = 0; i < header.count; ++i) {
      header.at.store(i, std::memory_order_relaxed);
      header.calls.fetch_add(1, std::memory_order_release);
      const Fault fault =
          call->run(header, exchange.props(), exchange.point(i), exchange.statev(i));
      if (fault == Fault::none) continue;
      if (fault == Fault::beyond_array) {
        say(call->damaged()->name());
        std::strncat(header.message, ", before its beginning", 40);
      }
      give_up(fault, 0);
      return 1;
    }
    ::alarm(0);
    current = nullptr;
    if (request % 256 == 0) keep_log_short();
    answer();
  }
  return 0;
}

}  // namespace
}  // namespace repose::umat

int main(int argc, char** argv) {
  using namespace repose::umat;
  if (argc != 5) return 2;  // nobody but repose has anything to say to it
  const int fd = std::atoi(argv[1]);
  struct stat size {};
  if (::fstat(fd, &size) != 0 || static_cast<std::size_t>(size.st_size) < sizeof(Header)) return 2;
  void* const memory = ::mmap(nullptr, static_cast<std::size_t>(size.st_size),
                              PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (memory == MAP_FAILED) return 2;
  ::close(fd);
  const Exchange exchange(memory);
  shared = &exchange.header();
  const rlimit no_core{0, 0}, file_size{1 << 28, 1 << 28};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_FSIZE, &file_size);
  catch_signals();
  std::thread(end_with_repose).detach();
  ::on_exit(on_end, nullptr);
  const int status = serve(exchange, argv[2], argv[3], argv[4]);
  std::fflush(nullptr);
  ::_exit(status);
}
