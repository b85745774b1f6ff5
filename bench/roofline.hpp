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

/// Bytes per second of a = b + s c over three arrays of that many bytes together: two loads and a
/// store, without write allocation. Sizes are rounded to a power of two from 256 KiB to 512 MiB,
/// and each is measured once: what a working set of that size can have, whatever cache it lies in.
double triad_bandwidth(double bytes);

}  // namespace repose::bench
