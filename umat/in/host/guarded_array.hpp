#pragma once
/// \file
/// An argument of a UMAT, placed so that whoever writes beyond it is found out: it ends where a
/// page begins that nobody may touch, and known numbers lie before it.

#include <cstddef>
#include <cstdint>

namespace repose::umat {

class GuardedArray {
 public:
  /// `name` as in Abaqus' manual. Errors: std::bad_alloc.
  GuardedArray(const char* name, std::size_t doubles);
  GuardedArray(const GuardedArray&) = delete;
  GuardedArray& operator=(const GuardedArray&) = delete;

  double* data() const { return data_; }
  const char* name() const { return name_; }
  std::size_t size() const { return size_; }

  /// Is what lies before it as it was?
  bool intact() const;
  /// Does the address lie on a page around it that nobody may touch?
  bool guards(const void* address) const;
  /// Is that page the one behind it?
  bool is_behind(const void* address) const { return address >= end_; }

 private:
  const char* name_;
  std::size_t size_;
  std::size_t canaries_;
  std::byte* begin_;      ///< of the mapping, a guard page
  std::byte* end_;        ///< of what may be touched
  std::byte* whole_end_;  ///< of the mapping, behind the second guard page
  double* data_;
};

}  // namespace repose::umat
