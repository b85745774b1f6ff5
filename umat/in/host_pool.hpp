#pragma once
/// \file
/// Processes that wait for work: each thread that asks has one to itself while it needs it.

#include <memory>

#include "umat/in/host_process.hpp"

namespace repose::umat {

/// A process on loan; given back at the end of the scope if it lives.
class HostLease {
 public:
  /// One that waits, else a new one. Errors: Failure.
  explicit HostLease(const Library& library);
  ~HostLease();
  HostLease(const HostLease&) = delete;
  HostLease& operator=(const HostLease&) = delete;
  HostProcess* operator->() const { return process_.get(); }
  HostProcess& operator*() const { return *process_; }

 private:
  std::unique_ptr<HostProcess> process_;
};

}  // namespace repose::umat
