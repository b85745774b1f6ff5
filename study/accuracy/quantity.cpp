#include "study/accuracy/quantity.hpp"

#include <algorithm>
#include <cmath>

namespace repose::study {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Volume left of x under the piecewise linear depth.
class Volume {
 public:
  Volume(const std::vector<double>& x, const std::vector<double>& depth) : x_(x), depth_(depth) {
    sum_.assign(x.size(), 0.0);
    for (std::size_t i = 1; i < x.size(); ++i)
      sum_[i] = sum_[i - 1] + 0.5 * (depth[i - 1] + depth[i]) * (x[i] - x[i - 1]);
  }
  double left_of(double x) const {
    const auto above = std::upper_bound(x_.begin(), x_.end(), x);
    if (above == x_.begin()) return 0.0;
    if (above == x_.end()) return sum_.back();
    const auto i = static_cast<std::size_t>(above - x_.begin()) - 1;
    const double t = x - x_[i];
    const double slope = (depth_[i + 1] - depth_[i]) / (x_[i + 1] - x_[i]);
    return sum_[i] + t * (depth_[i] + 0.5 * slope * t);
  }

 private:
  const std::vector<double>&x_, &depth_;
  std::vector<double> sum_;
};

}  // namespace

std::string_view column_of(Quantity q, std::size_t dimensions) {
  if (q == Quantity::kinetic && dimensions == 3) return "kinetic_J";
  constexpr std::array<std::string_view, quantity_count> columns{
      "front_m", "front_99_m", "height_m", "depth_m", "kinetic_J_per_m", "momentum_x"};
  return columns[static_cast<std::size_t>(q)];
}

std::string_view unit_of(Quantity q, std::size_t dimensions) {
  const bool in_space = dimensions == 3;
  if (q == Quantity::momentum) return in_space ? "kg m/s" : "kg/s";  // kg m/s per m
  if (q == Quantity::kinetic) return in_space ? "J" : "J/m";
  return "m";
}

VectorXd shares_of(const SweepRun& run, Quantity q, double bin) {
  if (!is_curve(q)) return VectorXd::Constant(1, run.figure(column_of(q)));
  if (q == Quantity::profile) {
    const Volume volume(run.x_m, run.depth_m);
    const auto bins = static_cast<Index>(std::lround(run.scene().domain[0] / bin));
    VectorXd shares(bins);
    for (Index i = 0; i < bins; ++i)
      shares[i] = volume.left_of(static_cast<double>(i + 1) * bin) -
                  volume.left_of(static_cast<double>(i) * bin);
    return shares;
  }
  const auto column = run.series.find(column_of(q, run.scene().dimensions()));
  if (column == run.series.end()) return VectorXd::Constant(1, std::nan(""));
  const std::vector<double>& rows = column->second;
  return run.scene().series_interval *
         Eigen::Map<const VectorXd>(rows.data(), static_cast<Index>(rows.size()));
}

namespace {

/// Area of a disc left of x, measured from its centre.
double disc_left_of(double x, double radius) {
  if (radius == 0.0) return 0.0;
  const double t = std::clamp(x, -radius, radius);
  return t * std::sqrt(radius * radius - t * t) +
         radius * radius * (std::asin(t / radius) + 0.5 * M_PI);
}

double area_left_of(const mpm::Body& body, double x) {
  if (body.polygon) {
    const auto& [left, low, depth] = body.origin;
    return mpm::piece_of(
               mpm::clipped(*body.polygon, {left, low}, {std::max(left, x), low + body.size[1]}))
        .area;
  }
  if (!body.disc) return body.size[1] * std::clamp(x - body.origin[0], 0.0, body.size[0]);
  const double from_centre = x - body.disc->centre[0];
  return disc_left_of(from_centre, body.disc->radius) - disc_left_of(from_centre, body.disc->hole);
}

}  // namespace

std::optional<VectorXd> start_of(const SweepRun& run, Quantity q, double bin) {
  const mpm::Scene& scene = run.scene();
  if (!is_curve(q)) {
    const auto column = run.series.find(column_of(q));
    if (column == run.series.end() || column->second.empty()) return {};
    return VectorXd::Constant(1, column->second.front());
  }
  // surfaces and other shapes cut bodies, by how much nobody says
  if (q != Quantity::profile || scene.dimensions() == 3 || !scene.surfaces.empty() ||
      std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const mpm::Body& body) {
        return mpm::is_cut(body) && !mpm::is_plain_polygon(body);
      }))
    return {};
  VectorXd shares = VectorXd::Zero(static_cast<Index>(std::lround(scene.domain[0] / bin)));
  for (const mpm::Body& body : scene.bodies)
    for (Index i = 0; i < shares.size(); ++i)
      shares[i] += area_left_of(body, static_cast<double>(i + 1) * bin) -
                   area_left_of(body, static_cast<double>(i) * bin);
  return shares;
}

QuantityCurve curve_of(const VectorXd& shares, Quantity q, const mpm::Scene& scene, double bin) {
  QuantityCurve curve;
  const double width = q == Quantity::profile ? bin : scene.series_interval;
  const double first = q == Quantity::profile ? 0.5 : 0.0;  // the middle of a column; rows from 0 s
  for (Index i = 0; i < shares.size(); ++i) {
    curve.x.push_back((static_cast<double>(i) + first) * width);
    curve.y.push_back(shares[i] / width);
  }
  return curve;
}

double length_of(const mpm::Scene& scene) {
  double area = 0.0;
  for (const mpm::Body& body : scene.bodies)
    area += body.polygon ? mpm::piece_of(*body.polygon).area
            : body.disc  ? M_PI * (std::pow(body.disc->radius, 2) - std::pow(body.disc->hole, 2))
            : body.solid && scene.dimensions() == 2 ? volume_of(scene, body)
                                                    : body.size[0] * body.size[1];
  return std::sqrt(area);
}

}  // namespace repose::study
