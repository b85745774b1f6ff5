#pragma once
/// \file
/// The picture of a point test (curve.svg).

#include "input/read_point_test.hpp"
#include "report/plot/figure.hpp"

namespace repose::report {

/// As the users of each kind of test draw it. Triaxial: q–p′ with yield surfaces and critical state
/// line, undrained with the total stress path; q–ε_a, ε_v (or u) – ε_a, v–ln p′. Oedometer:
/// e–log σ′_a, q–p′, K0. Isotropic: v–ln p′, ε_v–p′. Simple shear: τ–γ, τ–σ′_yy, and μ–I where the
/// law has an inertial number. Stages and the last of several cycles in colours of their own;
/// stresses in kPa, strains in per cent. changes: "initial.ocr = 8", for the title.
Figure point_picture(const input::PointTestFile& file, std::span<const double> theta,
                     const point::Curve& curve, std::string_view changes = {});

}  // namespace repose::report
