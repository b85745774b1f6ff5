#pragma once
/// \file
/// What one point-step of the Material Point Method takes: floating-point operations and bytes to
/// and from memory, counted from the source and not measured, for the roofline of bench/mpm.cpp.

#include <optional>

#include "bench/mid_collapse.hpp"

namespace repose::bench {

struct Work {
  double flops = 0.0, bytes = 0.0;  ///< per point-step
};

/// All stages of a step without the law; absent for a transfer that the table does not know.
std::optional<Work> transfer_work(mpm::Kernel kernel, mpm::Transfer transfer, std::size_t states,
                                  bool viscous, double tiles_per_point,
                                  double node_blocks_per_point);

/// Operations of the law's update for these points, averaged: the law is run with Counted numbers,
/// so lanes that wait for others do not count.
double law_flops(const LawSpec& law, const mpm::MidCollapse::Sample& points);

}  // namespace repose::bench
