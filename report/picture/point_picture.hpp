#pragma once
/// \file
/// The picture of a point test (curve.svg).

#include "input/read_point_test.hpp"
#include "report/plot/figure.hpp"

namespace repose::report {

/// q–p with yield surface and critical state line, q–ε_a, ε_v (or u) – ε_a, v–ln p; for shear tests
/// τ–γ, τ–p, and μ–I where the law has an inertial number. Stresses in kPa, strains in per cent.
Figure point_picture(const input::PointTestFile& file, std::span<const double> theta,
                     const point::Curve& curve);

}  // namespace repose::report
