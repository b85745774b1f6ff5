#include "app/exact_flow.hpp"

#include <cmath>

#include <fmt/format.h>

namespace repose::app {
namespace {

using mpm::Wall;

constexpr double pi = M_PI;
constexpr int modes = 200;

/// A layer of depth H on a fixed floor; u = U f(y/H, t).
struct Layer {
  double length, H;  ///< [m]
  double rho, nu;    ///< [kg/m³], [m²/s]
  double U;          ///< velocity that the closed form is measured in [m/s]
};

/// Mean of f and of f² over the depth.
struct Means {
  double velocity, square;
};

/// f = s + Σ b_m sin(mπs) e_m with b_m = 2(−1)^m/(mπ) and e_m = exp(−m²π²νt/H²), s = y/H.
Means couette(const Layer& layer, double t) {
  Means mean{0.5, 1.0 / 3.0};
  for (int m = 1; m < modes; ++m) {
    const double square = m * m * pi * pi;
    const double e = std::exp(-square * layer.nu * t / (layer.H * layer.H));
    if (m % 2 == 1) mean.velocity -= 4.0 / square * e;
    mean.square += (2.0 * e * e - 4.0 * e) / square;
  }
  return mean;
}

/// f = s − s²/2 − Σ over odd m of (16/m³π³) sin(mπs/2) e_m with e_m = exp(−m²π²νt/4H²), measured
/// in U = g sin(tilt) H²/ν.
Means inclined(const Layer& layer, double t) {
  Means mean{1.0 / 3.0, 2.0 / 15.0};
  for (int m = 1; m < modes; m += 2) {
    const double square = m * m * pi * pi;
    const double e = std::exp(-square * layer.nu * t / (4.0 * layer.H * layer.H));
    mean.velocity -= 32.0 / (square * square) * e;
    mean.square += 128.0 * (e * e - 2.0 * e) / (square * square * square);
  }
  return mean;
}

Layer layer_of(ExactFlow flow, const mpm::Scene& scene) {
  const auto need = [&](bool given, std::string_view what) {
    if (!given)
      throw InputError("chart.exact",
                       fmt::format("the closed form of {} needs {}",
                                   exact_flow_names[static_cast<std::size_t>(flow)], what));
  };
  need(scene.dimensions() == 2 && scene.bodies.size() == 1 && !scene.bodies[0].disc,
       "one box in the plane");
  const mpm::Body& body = scene.bodies[0];
  need(body.law.name == "newtonian", "a newtonian fluid");
  need(scene.left.kind == Wall::Kind::periodic && scene.right.kind == Wall::Kind::periodic,
       "periodic edges left and right");
  need(body.origin[0] == 0.0 && body.origin[1] == 0.0 && body.size[0] == scene.domain[0],
       "a body that fills the floor");
  need(body.velocity[0] == 0.0 && body.velocity[1] == 0.0, "a start at rest");
  need(scene.floor.kind == Wall::Kind::no_slip && scene.floor.speed == 0.0, "floor = \"no_slip\"");
  const LawInfo& law = find_law(body.law);
  const std::vector<double> theta = checked_parameters(body.law);
  const auto value = [&](std::string_view name) {
    for (std::size_t k = 0; k < law.parameters.size(); ++k)
      if (law.parameters[k].name == name) return theta[k];
    return std::nan("");
  };
  Layer layer{body.size[0], body.size[1], value("rho_0"), 0.0, 0.0};
  layer.nu = value("eta") / layer.rho;
  if (flow == ExactFlow::couette) {
    need(scene.gravity == 0.0, "gravity = 0");
    need(scene.top.kind == Wall::Kind::no_slip && scene.top.speed != 0.0, "top = { speed = V }");
    need(body.size[1] == scene.domain[1], "a body that fills the box");
    layer.U = scene.top.speed;
  } else {
    need(body.size[1] < scene.domain[1], "room above the body");
    need(scene.gravity > 0.0 && scene.tilt_deg != 0.0, "gravity and tilt_deg");
    layer.U = scene.gravity * std::sin(scene.tilt_deg * pi / 180.0) * layer.H * layer.H / layer.nu;
  }
  return layer;
}

}  // namespace

std::optional<Eigen::VectorXd> exact_shares(ExactFlow flow, const mpm::Scene& scene, Quantity q) {
  const Layer layer = layer_of(flow, scene);
  if (q != Quantity::kinetic && q != Quantity::momentum) return {};
  const double mass = layer.rho * layer.length * layer.H;  // per metre across
  const auto rows = std::lround(scene.end_time / scene.series_interval) + 1;
  Eigen::VectorXd shares(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = static_cast<double>(i) * scene.series_interval;
    const Means mean = flow == ExactFlow::couette ? couette(layer, t) : inclined(layer, t);
    shares[i] =
        scene.series_interval * mass *
        (q == Quantity::momentum ? layer.U * mean.velocity : 0.5 * layer.U * layer.U * mean.square);
  }
  return shares;
}

}  // namespace repose::app
