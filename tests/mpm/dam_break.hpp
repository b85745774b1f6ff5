#pragma once
/// \file
/// Dam breaks on a dry, level bed: Ritter's (1892) solution of the shallow-water equations,
///   depth = (2c_0 − x/t)²/9g, u = ⅔(c_0 + x/t) for −c_0 ≤ x/t ≤ 2c_0, c_0 = √(gH),
/// with x from the dam, and the column of Martin & Moyce (1952).
///
/// How far the first is from a flow in two dimensions: by the next order of depth over length
/// (Serre 1953) the pressure on a section is more than hydrostatic by the share ⅔ (depth/g)
/// (u_x² − u_xt − u u_xx), which for Ritter's u is (20/27) depth/(gt²); and the fluid needs a few
/// times √(H/g) before it flows along the bed at all. Both fade in units of √(H/g).

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "mpm/step/simulation.hpp"
#include "tests/mpm/scenes.hpp"

namespace repose::mpm {

struct DamBreak {
  double W = 0.05715, H = 0.1143;  ///< the water behind the dam [m]; 2¼ and 4½ inches
  double length = 7.0 * 0.05715;   ///< of the box [m]
  double g = 9.8, rho = 1000.0, eta = 1e-3;
  /// Speed of sound over √(gH): the fastest water is twice that fast, at a tenth of sound.
  double stiffness = 20.0;

  /// Cells of size h over a bed with or without friction; water that may tear.
  Scene scene(double h, Wall::Kind bed, Transfer transfer = Transfer::relaxed) const {
    Scene s = empty_box(length, std::ceil(1.25 * H / h) * h, h);
    s.gravity = g;
    s.floor = {bed};
    s.transfer = transfer;
    s.courant = 0.8;
    // αK = ρc²
    const double K = rho * stiffness * stiffness * g * H / 7.0;
    s.bodies = {block(0.0, 0.0, W, H, newtonian(eta, K, 7.0, rho))};
    s.bodies[0].lithostatic = true;
    return s;
  }
};

/// Depth at x [m] from the dam, t [s] after it broke.
inline double ritter_depth(double H, double g, double x, double t) {
  const double c_0 = std::sqrt(g * H), xi = std::clamp(x / t, -c_0, 2.0 * c_0);
  return (2.0 * c_0 - xi) * (2.0 * c_0 - xi) / (9.0 * g);
}

/// A reservoir so long that its end knows of nothing until `end` √(H/g) after the dam broke.
inline DamBreak long_reservoir(double end) {
  DamBreak dam;
  dam.H = 1.0;
  dam.W = std::ceil(1.1 * end) * dam.H;
  dam.length = dam.W + std::ceil(2.2 * end) * dam.H;
  dam.eta = 1e-3;
  return dam;
}

/// Depths of a long reservoir against Ritter's, where −0.7 < x/c_0 t < 1.1: away from both ends,
/// where Ritter's depth has a kink in slope, or is thinner than 0.09 H.
struct RitterError {
  double rms;     ///< of depth over H, along x
  double at_dam;  ///< depth over H at x = 0, 4/9 at all times
};
inline RitterError ritter_error(const Simulation& simulation, const DamBreak& dam) {
  const double t = simulation.time(), c_0 = std::sqrt(dam.g * dam.H);
  const Simulation::Profile profile = simulation.profile();
  RitterError error{0.0, 0.0};
  double count = 0.0;
  for (std::size_t i = 0; i < profile.x_m.size(); ++i) {
    const double x = profile.x_m[i] - dam.W, depth = profile.depth_m[i] / dam.H;
    if (std::abs(x) < 1e-9) error.at_dam = depth;
    if (x < -0.7 * c_0 * t || x > 1.1 * c_0 * t) continue;
    error.rms += std::pow(depth - ritter_depth(dam.H, dam.g, x, t) / dam.H, 2);
    ++count;
  }
  error.rms = std::sqrt(error.rms / count);
  return error;
}

/// The rows of a table of two columns, comments and header left out.
inline std::vector<std::array<double, 2>> two_columns(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::array<double, 2>> rows;
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells(line);
    std::array<double, 2> row{};
    char comma = 0;
    if (cells >> row[0] >> comma >> row[1]) rows.push_back(row);
  }
  return rows;
}

}  // namespace repose::mpm
