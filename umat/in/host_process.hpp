#pragma once
/// \file
/// A process of its own for a foreign UMAT, and the exchange of points with it. What the library
/// does to its process, repose survives and can tell.

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

#include <sys/types.h>

#include "umat/in/wire.hpp"

namespace repose::umat {

/// Which function, and how it is called.
struct Library {
  std::filesystem::path file;  ///< absolute
  std::string content;         ///< a fingerprint of it: a library that is built anew is another one
  std::string symbol = "umat_";
  std::string cmname = "UMAT";  ///< the material's name, CMNAME
  std::size_t nprops = 0, nstatv = 0;
  double time_limit_s = 10.0;  ///< CPU time of a call
  friend bool operator==(const Library&, const Library&) = default;
};

/// A library that does not do what it should: what() says which, what happened, and what it printed
/// last.
class Failure : public std::runtime_error {
 public:
  Failure(Fault fault, std::size_t point, const std::string& message)
      : std::runtime_error(message),
        fault_(fault),
        point_(point) {}
  Fault fault() const { return fault_; }
  std::size_t point() const { return point_; }  ///< of the exchange

 private:
  Fault fault_;
  std::size_t point_;
};

/// "umat_crashed", "umat_beyond_array": by which a fit counts failed trials. Static text.
std::string_view word(Fault fault);

/// The program that runs libraries: what the environment variable REPOSE_UMAT_HOST names, else
/// repose-umat-host beside this program or in ../libexec/repose. Errors: Failure (no_host).
std::filesystem::path host_program();

class HostProcess {
 public:
  /// Starts the process and loads the library. Errors: Failure.
  explicit HostProcess(const Library& library);
  ~HostProcess();
  HostProcess(const HostProcess&) = delete;
  HostProcess& operator=(const HostProcess&) = delete;

  const Library& library() const { return library_; }
  const Exchange& exchange() const { return exchange_; }

  /// Calls the UMAT for the first `count` <= exchange_capacity records, in their order;
  /// `subdivide`: PNEWDT < 1 is followed by smaller increments. Results that are not finite are a
  /// failure. After a Failure but not_finite the process is gone: alive() is false.
  void run(std::size_t count, std::size_t ntens, bool subdivide);
  bool alive() const { return pid_ > 0; }

 private:
  void await(std::uint32_t request);
  void end();
  /// Reads the fault from the shared memory and throws.
  [[noreturn]] void fail();
  [[noreturn]] void fail(Fault fault, std::size_t point, const std::string& what);
  /// The last lines that the library has printed, for a message.
  std::string printed() const;
  void check_finite(std::size_t count, std::size_t ntens);

  Library library_;
  Exchange exchange_;
  void* memory_ = nullptr;
  std::size_t bytes_ = 0;
  int log_ = -1;
  pid_t pid_ = -1;
};

}  // namespace repose::umat
