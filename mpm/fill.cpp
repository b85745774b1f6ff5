#include "mpm/fill.hpp"

#include <cmath>
#include <numbers>

namespace repose::mpm {
namespace {

/// Runs f and makes the keys of its InputErrors relative to the body.
template <class F>
auto within(const std::string& table, F&& f) {
  try {
    return f();
  } catch (const InputError& e) {
    throw InputError(table + "." + e.key(), e.what());
  }
}

void append(PointSet& points, double x, double y, const Body& body, const InitialPoint& at,
            double area, std::int64_t id) {
  const double cx = body.origin[0] + 0.5 * body.size[0];
  const double cy = body.origin[1] + 0.5 * body.size[1];
  points.field[X].push_back(x);
  points.field[Y].push_back(y);
  points.field[VX].push_back(body.velocity[0] - body.spin * (y - cy));
  points.field[VY].push_back(body.velocity[1] + body.spin * (x - cx));
  points.field[LXX].push_back(0.0);
  points.field[LXY].push_back(-body.spin);
  points.field[LYX].push_back(body.spin);
  points.field[LYY].push_back(0.0);
  for (int k = 0; k < 4; ++k)
    points.field[SXX + static_cast<std::size_t>(k)].push_back(at.stress[k]);
  points.field[RHO].push_back(at.density);
  points.field[MASS].push_back(at.density * area);
  for (std::size_t k = 0; k < at.state.size(); ++k) points.field[STATE + k].push_back(at.state[k]);
  if (points.splits_stress()) {
    points.field[points.force_stress[0]].push_back(mean(at.stress));
    points.field[points.force_stress[2]].push_back(0.0);
  }
  if (points.affine != LXX)
    for (std::size_t k = 0; k < affine_fields; ++k)
      points.field[points.affine + k].push_back(points.field[LXX + k].back());
  points.id.push_back(id);
  ++points.count;
}

/// In the box, or in the disc and not in its hole.
bool within_shape(const Body& body, double x, double y) {
  if (!body.disc) return true;
  const double r = std::hypot(x - body.disc->centre[0], y - body.disc->centre[1]);
  return r >= body.disc->hole && r < body.disc->radius;
}

}  // namespace

double overburden(const Material& material, double ocr, double K0, double g, double z, int steps) {
  const auto weight = [&](double vertical) {
    return g * material.density_at(vertical * (1.0 + 2.0 * K0) / 3.0, ocr);
  };
  const double dz = z / steps;
  double s = 0.0;
  for (int k = 0; k < steps; ++k) {
    const double k1 = weight(s);
    const double k2 = weight(s + 0.5 * dz * k1);
    const double k3 = weight(s + 0.5 * dz * k2);
    const double k4 = weight(s + dz * k3);
    s += dz / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return s;
}

PointSet fill(const Body& body, const Scene& scene, std::int64_t first_id) {
  PointSet points;
  points.material =
      within("law", [&] { return std::shared_ptr<const Material>(make_material(body.law)); });
  points.fields = STATE + points.material->law().state.size();
  if (scene.viscosity == Viscosity::implicit_solve && !points.material->law().has_stress_memory) {
    points.force_stress = {points.fields, points.fields, points.fields + 1};
    points.fields += split_fields;
  }
  if (scene.transfer == Transfer::relaxed) {
    points.affine = points.fields;
    points.fields += affine_fields;
  }

  const double spacing = scene.h / std::sqrt(static_cast<double>(scene.points_per_cell));
  const auto nx = static_cast<std::int64_t>(std::llround(body.size[0] / spacing));
  const auto ny = static_cast<std::int64_t>(std::llround(body.size[1] / spacing));
  const double dx = body.size[0] / static_cast<double>(nx);
  const double dy = body.size[1] / static_cast<double>(ny);
  const double g = scene.gravity * std::cos(scene.tilt_deg * std::numbers::pi / 180.0);
  const double K0 = body.initial.K0.value_or(1.0);

  const auto initial = [&](const InitialConditions& given) {
    return within("initial", [&] { return points.material->initial(given); });
  };
  InitialPoint uniform;
  if (!body.lithostatic) uniform = initial(body.initial);
  for (std::int64_t j = 0; j < ny; ++j) {
    const double y = body.origin[1] + (static_cast<double>(j) + 0.5) * dy;
    InitialPoint at = uniform;
    if (body.lithostatic) {
      const double depth = body.origin[1] + body.size[1] - y;
      InitialConditions here = body.initial;
      here.p = within("initial", [&] {
        // steps of a quarter spacing: the error of the fourth-order rule is far below round-off of
        // σ
        const int steps = static_cast<int>(std::ceil(depth / (0.25 * dy)));
        return overburden(*points.material, body.initial.ocr.value_or(1.0), K0, g, depth, steps) *
               (1.0 + 2.0 * K0) / 3.0;
      });
      at = initial(here);
    }
    for (std::int64_t i = 0; i < nx; ++i) {
      const double x = body.origin[0] + (static_cast<double>(i) + 0.5) * dx;
      if (!within_shape(body, x, y)) continue;
      append(points, x, y, body, at, dx * dy, first_id + static_cast<std::int64_t>(points.count));
    }
  }
  // solid depths are measured at the loosest density the law knows by name, else as filled
  points.rho_0 = points.field[RHO].empty() ? 0.0 : points.field[RHO].back();
  for (std::size_t k = 0; k < points.material->law().parameters.size(); ++k)
    if (points.material->law().parameters[k].name == "rho_0")
      points.rho_0 = points.material->theta()[k];
  return points;
}

}  // namespace repose::mpm
