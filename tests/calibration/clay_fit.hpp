#pragma once
/// \file
/// The fit that tests of the command share: London clay's M and κ from an undrained compression.

namespace repose {

/// Up to and with its target, measured in cu.csv.
constexpr const char* clay_fit = R"([law]
name = "modified_cam_clay"
compression = "ln_v-ln_p"
lambda = 0.161
nu = 0.3
Gamma = 2.759
[fit]
M = { lower = 0.4, upper = 1.8 }
kappa = { lower = 0.02, upper = 0.15, scale = "log" }
[[target]]
data = "cu.csv"
x = "eps_a"
y = ["q_Pa", "u_Pa"]
test = { kind = "triaxial", drainage = "undrained", axial_strain = 0.1 }
initial = { p = 200e3, ocr = 1.0 }
)";

}  // namespace repose
