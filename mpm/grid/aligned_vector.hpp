#pragma once
/// \file
/// Memory that starts on a cache line, so that no SIMD register straddles two.

#include <cstddef>
#include <new>
#include <vector>

namespace repose::mpm {

inline constexpr std::align_val_t cache_line{64};

template <class T>
struct CacheLineAllocator {
  using value_type = T;
  CacheLineAllocator() = default;
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), cache_line)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, cache_line); }
  friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
};

template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace repose::mpm
