#pragma once

#include <mutex>

namespace repose::io {

/// While one lives, this thread alone calls HDF5: its library need not be built for several, and
/// even one that is takes two files in memory of the same name for one. One within another is the
/// same thread's.
class Hdf5Lock {
 public:
  Hdf5Lock() : lock_(mutex()) {}

 private:
  static std::recursive_mutex& mutex() {
    static std::recursive_mutex one;
    return one;
  }
  std::lock_guard<std::recursive_mutex> lock_;
};

}  // namespace repose::io
