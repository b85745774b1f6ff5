#pragma once
/// \file
/// What one core of this machine can do at most, measured: the two sides of a roofline.

#include <cstddef>
#include <vector>

namespace repose::bench {

/// Floating-point operations per second of independent fused multiply-adds (2 operations each) on
/// registers of that many doubles. Errors: std::invalid_argument for a width the program is not
/// compiled for (register_widths()).
double peak_flops(std::size_t width);
/// 4 (256 bit), and 8 (512 bit) where the instruction set has it.
std::vector<std::size_t> register_widths();
/// The best of them.
double peak_flops();

struct MemoryLevel {
  const char* name;         ///< "L2", "L3", "DRAM"
  double holds;             ///< bytes that a working set may have to stay in it
  double triad_bytes;       ///< size of the three arrays that are measured
  double bytes_per_second;  ///< of a = b + s c: two loads and a store, without write allocation
};
/// Smallest first; measured at the first call (a second or so).
const std::vector<MemoryLevel>& memory_levels();
/// The level in which a working set of that many bytes lies.
const MemoryLevel& level_of(double bytes);

}  // namespace repose::bench
