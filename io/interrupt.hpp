#pragma once

namespace repose::io {

/// While one lives, the first SIGINT, SIGTERM or SIGHUP only sets a flag, so that a run can save
/// its state; the second one ends the program at once. nohup is respected. One within
/// another shares its flag.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  bool requested() const;
};

}  // namespace repose::io
