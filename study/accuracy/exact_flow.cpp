#include "study/accuracy/exact_flow.hpp"

#include <cmath>

#include <fmt/core.h>

#include "models/cone.hpp"
#include "study/accuracy/grain_layer.hpp"

namespace repose::study {
namespace {

using mpm::Wall;

constexpr double pi = M_PI;
constexpr int modes = 200;

/// A layer of fluid on a fixed floor; u = U f(y/H, t).
struct Layer {
  double H, nu;  ///< [m], [m²/s]
  double U;      ///< velocity that the closed form is measured in [m/s]

  LayerMeans scaled(double mean, double mean_square) const {
    return {U * mean, U * U * mean_square};
  }
};

/// f = s + Σ b_m sin(mπs) e_m with b_m = 2(−1)^m/(mπ) and e_m = exp(−m²π²νt/H²), s = y/H.
LayerMeans couette(const Layer& layer, double t) {
  double velocity = 0.5, square = 1.0 / 3.0;
  for (int m = 1; m < modes; ++m) {
    const double m2 = m * m * pi * pi;
    const double e = std::exp(-m2 * layer.nu * t / (layer.H * layer.H));
    if (m % 2 == 1) velocity -= 4.0 / m2 * e;
    square += (2.0 * e * e - 4.0 * e) / m2;
  }
  return layer.scaled(velocity, square);
}

/// f = s − s²/2 − Σ over odd m of (16/m³π³) sin(mπs/2) e_m with e_m = exp(−m²π²νt/4H²), measured
/// in U = g sin(tilt) H²/ν.
LayerMeans inclined(const Layer& layer, double t) {
  double velocity = 1.0 / 3.0, square = 2.0 / 15.0;
  for (int m = 1; m < modes; m += 2) {
    const double m2 = m * m * pi * pi;
    const double e = std::exp(-m2 * layer.nu * t / (4.0 * layer.H * layer.H));
    velocity -= 32.0 / (m2 * m2) * e;
    square += 128.0 * (e * e - 2.0 * e) / (m2 * m2 * m2);
  }
  return layer.scaled(velocity, square);
}

/// What a flow needs of its scene; InputError with what it lacks.
class FlowReader {
 public:
  FlowReader(input::ExactFlow flow, const mpm::Scene& scene)
      : flow_(flow),
        scene_(scene),
        body_(scene.bodies.at(0)) {
    need(scene.dimensions() == 2 && scene.bodies.size() == 1 && is_box(body_) &&
             scene.surfaces.empty() && scene.inflows.empty(),
         "one box in the plane, without surfaces");
    need(scene.left.kind == Wall::Kind::periodic && scene.right.kind == Wall::Kind::periodic,
         "periodic edges left and right");
    need(body_.origin[0] == 0.0 && body_.origin[1] == 0.0 && body_.size[0] == scene.domain[0],
         "a body that fills the floor");
    need(body_.velocity[0] == 0.0 && body_.velocity[1] == 0.0, "a start at rest");
    need(scene.floor.kind == Wall::Kind::no_slip && scene.floor.speed == 0.0,
         "floor = \"no_slip\"");
    if (flow == input::ExactFlow::couette) {
      need(scene.gravity == 0.0, "gravity = 0");
      need(scene.top.kind == Wall::Kind::no_slip && scene.top.speed != 0.0, "top = { speed = V }");
      need(body_.size[1] == scene.domain[1], "a body that fills the box");
    } else {
      need(body_.size[1] < scene.domain[1], "room above the body");
      need(scene.gravity > 0.0 && scene.tilt_deg != 0.0, "gravity and tilt_deg");
    }
  }

  double mass() const {  ///< per metre across
    return value("rho_0") * body_.size[0] * body_.size[1];
  }

  Layer fluid() const {
    need(body_.law.name == "newtonian", "a newtonian fluid");
    Layer layer{body_.size[1], value("eta") / value("rho_0"), scene_.top.speed};
    if (flow_ == input::ExactFlow::inclined_layer)
      layer.U = scene_.gravity * std::sin(tilt()) * layer.H * layer.H / layer.nu;
    return layer;
  }

  GrainLayer grains() const {
    const auto form = body_.law.options.find("form");
    need(body_.law.name == "mu_i" &&
             (form == body_.law.options.end() || form->second == "elastoviscoplastic"),
         "mu_i grains, form = \"elastoviscoplastic\"");
    // of simple shear, where the cone is not round
    const double share = cone::shear_share(value("shape"), std::sqrt(3.0) * value("mu_0"));
    const double mu_0 = share * value("mu_0"), mu_d = share * value("mu_d");
    need(mu_0 < std::tan(tilt()) && std::tan(tilt()) < mu_d,
         "tilt_deg between the angles of mu_0 and mu_d");
    return {.H = body_.size[1],
            .g = scene_.gravity,
            .tilt = tilt(),
            .mu_0 = mu_0,
            .mu_d = mu_d,
            .I_0 = value("I_0"),
            .d = value("d"),
            .rho_p = value("rho_p"),
            .rho = value("rho_0"),
            .G = value("G")};
  }

 private:
  double tilt() const { return scene_.tilt_deg * pi / 180.0; }

  void need(bool given, std::string_view what) const {
    if (!given)
      throw InputError("chart.exact",
                       fmt::format("chart.exact = \"{}\" needs {}",
                                   input::exact_flow_names[static_cast<std::size_t>(flow_)], what));
  }

  double value(std::string_view name) const {
    const LawInfo& law = find_law(body_.law);
    const std::vector<double> theta = checked_parameters(body_.law);
    for (std::size_t k = 0; k < law.parameters.size(); ++k)
      if (law.parameters[k].name == name) return theta[k];
    return std::nan("");
  }

  input::ExactFlow flow_;
  const mpm::Scene& scene_;
  const mpm::Body& body_;
};

}  // namespace

std::optional<Eigen::VectorXd> exact_shares(input::ExactFlow flow, const mpm::Scene& scene,
                                            Quantity q) {
  const FlowReader reader(flow, scene);
  const auto rows =
      static_cast<std::size_t>(std::lround(scene.end_time / scene.series_interval)) + 1;
  std::vector<LayerMeans> means;
  if (flow == input::ExactFlow::bagnold) {
    const GrainLayer layer = reader.grains();
    if (q == Quantity::kinetic || q == Quantity::momentum)
      means = starting_flow(layer, scene.series_interval, rows);
  } else {
    const Layer layer = reader.fluid();
    for (std::size_t i = 0; i < rows; ++i) {
      const double t = static_cast<double>(i) * scene.series_interval;
      means.push_back(flow == input::ExactFlow::couette ? couette(layer, t) : inclined(layer, t));
    }
  }
  if (q != Quantity::kinetic && q != Quantity::momentum) return {};
  Eigen::VectorXd shares(static_cast<Eigen::Index>(rows));
  for (std::size_t i = 0; i < rows; ++i)
    shares[static_cast<Eigen::Index>(i)] =
        scene.series_interval * reader.mass() *
        (q == Quantity::momentum ? means[i].velocity : 0.5 * means[i].square);
  return shares;
}

}  // namespace repose::study
