#pragma once
/// \file
/// How much room a batch of points has. One number for every instruction set, so that a program and
/// the library agree whatever each is compiled for.

#include <cstddef>

namespace repose {

/// Batches are whole multiples of this many points: two registers of eight doubles, the widest that
/// a law is handed (scalar.hpp); narrower registers divide it.
inline constexpr std::size_t pack_size = 16;

/// `count` rounded up to a multiple of pack_size.
constexpr std::size_t padded(std::size_t count) {
  return (count + pack_size - 1) / pack_size * pack_size;
}

}  // namespace repose
