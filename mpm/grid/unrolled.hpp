#pragma once
/// \file
/// Loops that the compiler is to write out.

#include <type_traits>
#include <utility>

/// Numbers in registers stay there only if no function that is called for them takes their address.
#define REPOSE_INLINE __attribute__((always_inline))

namespace repose::mpm {

/// Calls f(integral_constant<k>) for k = 0 … n − 1.
template <std::size_t n, class F>
REPOSE_INLINE inline void unrolled(F&& f) {
  [&]<std::size_t... k>(std::index_sequence<k...>) REPOSE_INLINE {
    (f(std::integral_constant<std::size_t, k>{}), ...);
  }
  (std::make_index_sequence<n>{});
}

}  // namespace repose::mpm
