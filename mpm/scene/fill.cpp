#include "mpm/scene/fill.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "mpm/scene/restitution.hpp"

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

/// The weight of bodies upon a body, per area [Pa]. Bodies are looked up column by column: those
/// that stand over a place without a gap, from the body's top to a free surface.
class Load {
 public:
  Load(const Scene& scene, const Body& body, double g)
      : scene_(scene),
        body_(body),
        g_(g),
        gap_(0.5 * point_spacing(scene)) {}

  /// At (x, z); z counts in space only. The same stack of bodies is summed up once.
  double at(double x, double z) {
    std::vector<std::size_t> stack;
    for (double top = body_.origin[1] + body_.size[1];;) {
      const std::size_t next = upon(x, z, top);
      if (next == scene_.bodies.size()) break;
      stack.push_back(next);
      top = scene_.bodies[next].origin[1] + scene_.bodies[next].size[1];
    }
    const auto [place, is_new] = known_.try_emplace(stack, 0.0);
    if (is_new)
      for (std::size_t i = stack.size(); i-- > 0;)
        place->second = below(scene_.bodies[stack[i]], stack[i], place->second);
    return place->second;
  }

 private:
  /// The body whose base stands at this height over (x, z); the number of bodies if there is none.
  std::size_t upon(double x, double z, double height) const {
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      const Body& other = scene_.bodies[i];
      const auto spans = [&](std::size_t axis, double at) {
        return at >= other.origin[axis] && at < other.origin[axis] + other.size[axis];
      };
      if (&other == &body_ || std::abs(other.origin[1] - height) > gap_ || !spans(0, x)) continue;
      if (other.polygon)
        throw InputError("lithostatic", fmt::format("body[{}], which stands on this one, is a "
                                                    "polygon: its weight upon a place is not known",
                                                    i));
      if (scene_.dimensions() == 2 && other.disc) continue;  // it touches in a point
      if (scene_.dimensions() == 3 && !spans(2, z)) continue;
      if (other.disc) {
        const double r = std::hypot(x - other.disc->centre[0], z - other.disc->centre[1]);
        if (r < other.disc->hole || r >= other.disc->radius) continue;
      }
      return i;
    }
    return scene_.bodies.size();
  }

  /// The vertical stress below a body that carries `above`.
  double below(const Body& body, std::size_t index, double above) const {
    try {
      const std::unique_ptr<Material> material = make_material(body.law);
      if (!body.lithostatic)
        return above + g_ * material->initial(body.initial).density * body.size[1];
      const int steps = static_cast<int>(std::ceil(body.size[1] / (0.5 * gap_)));
      return overburden(*material, body.initial.ocr.value_or(1.0), body.initial.K0.value_or(1.0),
                        g_, body.size[1], steps, above);
    } catch (const InputError& e) {
      throw InputError("lithostatic", "body[" + std::to_string(index) +
                                          "], which stands on this one: " + e.what());
    }
  }

  const Scene& scene_;
  const Body& body_;
  double g_, gap_;
  std::map<std::vector<std::size_t>, double> known_;
};

/// In the box, or in the disc (in space, cylinder) and not in its hole.
template <int dim>
bool within_shape(const Body& body, const std::array<double, dim>& x) {
  if (!body.disc) return true;
  const double r = std::hypot(x[0] - body.disc->centre[0], x[dim - 1] - body.disc->centre[1]);
  return r >= body.disc->hole && r < body.disc->radius;
}

/// The rigid surfaces cut the bodies.
template <int dim>
bool behind_a_surface(const std::vector<Surface>& surfaces, const std::array<double, dim>& x) {
  Position place{};
  for (std::size_t i = 0; i < dim; ++i) place[i] = x[i];
  return std::any_of(surfaces.begin(), surfaces.end(),
                     [&](const Surface& surface) { return surface.holds_at(0.0, place); });
}

}  // namespace

template <int dim>
void add_point(PointsOf<dim>& points, const std::array<double, dim>& x,
               const std::array<double, dim>& velocity, double spin, const InitialPoint& at,
               double volume, std::int64_t id) {
  using F = Layout<dim>;
  for (std::size_t i = 0; i < dim; ++i) {
    points.append(F::x + i, x[i]);
    points.append(F::v + i, velocity[i]);
    for (std::size_t j = 0; j < dim; ++j)
      points.append(F::L + dim * i + j, i == 0 && j == 1 ? -spin : i == 1 && j == 0 ? spin : 0.0);
  }
  for (std::size_t k = 0; k < F::components; ++k) points.append(F::stress + k, at.stress.c[k]);
  points.append(F::rho, at.density);
  points.append(F::mass, at.density * volume);
  for (std::size_t k = 0; k < at.state.size(); ++k) points.append(F::state + k, at.state[k]);
  if (points.shear_strain != 0) points.append(points.shear_strain, 0.0);
  if (points.splits_stress()) {
    points.append(points.force_stress[0], mean(at.stress));
    points.append(points.force_stress[2], 0.0);
  }
  if (points.damps())
    for (std::size_t k = 0; k < points.force_stress.size(); ++k)
      points.append(points.force_stress[k],
                    at.stress.c[dim == 2 && k == 2 ? 3 : k]);  // xx, yy, xy of the plane
  if (points.affine != F::L)
    for (std::size_t k = 0; k < F::gradient; ++k)
      points.append(points.affine + k, points[F::L + k][points.id.size()]);
  points.id.push_back(id);
  ++points.count;
}

double overburden(const Material& material, double ocr, double K0, double g, double z, int steps,
                  double above) {
  const auto weight = [&](double vertical) {
    return g * material.density_at(vertical * (1.0 + 2.0 * K0) / 3.0, ocr);
  };
  const double dz = z / steps;
  double s = above;
  for (int k = 0; k < steps; ++k) {
    const double k1 = weight(s);
    const double k2 = weight(s + 0.5 * dz * k1);
    const double k3 = weight(s + 0.5 * dz * k2);
    const double k4 = weight(s + dz * k3);
    s += dz / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return s;
}

template <int dim>
PointsOf<dim> fill(const Body& body, const Scene& scene, std::int64_t first_id) {
  using F = Layout<dim>;
  PointsOf<dim> points;
  points.material =
      within("law", [&] { return std::shared_ptr<const Material>(make_material(body.law)); });
  points.fields = F::state + points.material->law().state.size();
  if (scene.shear_strain) points.shear_strain = points.fields++;
  if constexpr (dim == 2) {
    if (scene.viscosity == Viscosity::implicit_solve && !points.material->law().has_stress_memory) {
      points.force_stress = {points.fields, points.fields, points.fields + 1};
      points.fields += split_fields;
    }
  }
  if (body.restitution && *body.restitution < 1.0) {
    points.damping_length = damping_length(*body.restitution, points.material->parameter("d"));
    points.damped_signal = damped_signal(points.damping_length, scene.h);
    for (std::size_t& f : points.force_stress) f = points.fields++;
  }
  if (scene.transfer == Transfer::relaxed) {
    points.affine = points.fields;
    points.fields += F::gradient;
  }

  points.single = scene.storage == Storage::single_precision;

  std::array<std::int64_t, 3> lattice = point_lattice(scene, body);
  std::array<double, 3> origin = body.origin, spacing{};
  for (std::size_t i = 0; i < dim; ++i) spacing[i] = body.size[i] / static_cast<double>(lattice[i]);
  if (body.polygon)  // cut out of the grid's own lattice
    for (std::size_t i = 0; i < 2; ++i) {
      spacing[i] = point_spacing(scene);
      const double first = std::floor(body.origin[i] / spacing[i]);
      origin[i] = first * spacing[i];
      lattice[i] = std::llround(
          std::ceil((body.origin[i] + body.size[i]) / spacing[i] - lattice_tolerance) - first);
    }
  if (body.release)  // in columns on the grid's own lattice, of as many points as its depth takes
    for (const std::size_t i : {0U, 2U}) {
      spacing[i] = point_spacing(scene);
      const double first = std::floor(body.origin[i] / spacing[i]);
      origin[i] = first * spacing[i];
      lattice[i] = std::llround(std::ceil((body.origin[i] + body.size[i]) / spacing[i]) - first);
    }
  if (!body.release) points.reserve(static_cast<std::size_t>(lattice[0] * lattice[1] * lattice[2]));
  const std::vector<Surface> surfaces = rigid_surfaces(scene);
  double volume = 1.0;
  for (std::size_t i = 0; i < dim; ++i) volume *= spacing[i];
  const double g = scene.gravity * std::cos(scene.tilt_deg * std::numbers::pi / 180.0);
  const double K0 = body.initial.K0.value_or(1.0);

  const auto initial = [&](const InitialConditions& given) {
    return within("initial", [&] { return points.material->initial(given); });
  };
  InitialPoint uniform;
  if (!body.lithostatic) uniform = initial(body.initial);
  const auto coordinate = [&](std::size_t axis, std::int64_t n) {
    return origin[axis] + (static_cast<double>(n) + 0.5) * spacing[axis];
  };
  // what stands on each column of the lattice
  std::vector<double> load(static_cast<std::size_t>(lattice[0] * lattice[2]), 0.0);
  if (body.lithostatic && scene.bodies.size() > 1) {
    Load bodies(scene, body, g);
    for (std::int64_t k = 0; k < lattice[2]; ++k)
      for (std::int64_t i = 0; i < lattice[0]; ++i)
        load[static_cast<std::size_t>(k * lattice[0] + i)] =
            within("initial", [&] { return bodies.at(coordinate(0, i), coordinate(2, k)); });
  }
  const auto at_depth = [&](double depth, double above) {
    InitialConditions here = body.initial;
    here.p = within("initial", [&] {
      // steps of a quarter spacing: the error of the fourth-order rule is far below round-off of σ
      const int steps = static_cast<int>(std::ceil(depth / (0.25 * spacing[1])));
      return overburden(*points.material, body.initial.ocr.value_or(1.0), K0, g, depth, steps,
                        above) *
             (1.0 + 2.0 * K0) / 3.0;
    });
    return initial(here);
  };
  const auto put = [&](const std::array<double, dim>& x, const InitialPoint& at, double of_point) {
    // a body that turns does so about z
    const double cx = body.origin[0] + 0.5 * body.size[0];
    const double cy = body.origin[1] + 0.5 * body.size[1];
    const std::array<double, 3> turning{-body.spin * (x[1] - cy), body.spin * (x[0] - cx), 0.0};
    std::array<double, dim> velocity;
    for (std::size_t m = 0; m < dim; ++m) velocity[m] = body.velocity[m] + turning[m];
    add_point<dim>(points, x, velocity, body.spin, at, of_point,
                   first_id + static_cast<std::int64_t>(points.count));
  };
  if constexpr (dim == 3) {
    for (std::int64_t k = 0; body.release && k < lattice[2]; ++k)
      for (std::int64_t i = 0; i < lattice[0]; ++i) {
        const double x = coordinate(0, i), z = coordinate(2, k);
        const double of_column =
            scene.terrain->release->volume_over({x - 0.5 * spacing[0], z - 0.5 * spacing[2]},
                                                {x + 0.5 * spacing[0], z + 0.5 * spacing[2]});
        const double depth = of_column / (spacing[0] * spacing[2]);
        if (depth < 1e-12 * scene.h) continue;
        const double ground = scene.terrain->ground->height(x, z);
        const auto count = std::max<std::int64_t>(1, std::llround(depth / point_spacing(scene)));
        for (std::int64_t j = 0; j < count; ++j) {
          const double share = (static_cast<double>(j) + 0.5) / static_cast<double>(count);
          const std::array<double, dim> place{x, ground + share * depth, z};
          if (behind_a_surface<dim>(surfaces, place)) continue;
          put(place, body.lithostatic ? at_depth((1.0 - share) * depth, 0.0) : uniform,
              of_column / static_cast<double>(count));
        }
      }
  }
  for (std::int64_t j = 0; !body.release && j < lattice[1]; ++j) {
    const double y = coordinate(1, j);
    InitialPoint at = uniform;
    double above = std::numeric_limits<double>::quiet_NaN();  // of which `at` is made
    for (std::int64_t k = 0; k < lattice[2]; ++k)
      for (std::int64_t i = 0; i < lattice[0]; ++i) {
        const double here = load[static_cast<std::size_t>(k * lattice[0] + i)];
        if (body.lithostatic && here != above) {
          at = at_depth(body.origin[1] + body.size[1] - y, here);
          above = here;
        }
        std::array<double, dim> x{coordinate(0, i), y};
        if constexpr (dim == 3) x[2] = coordinate(2, k);
        double here_volume = volume;
        if (body.polygon) {
          const Piece piece =
              piece_of(clipped(*body.polygon, {x[0] - 0.5 * spacing[0], x[1] - 0.5 * spacing[1]},
                               {x[0] + 0.5 * spacing[0], x[1] + 0.5 * spacing[1]}));
          if (piece.area < 1e-12 * volume) continue;
          x[0] = piece.centroid[0];
          x[1] = piece.centroid[1];
          here_volume = piece.area;
        }
        if (!within_shape<dim>(body, x) || behind_a_surface<dim>(surfaces, x)) continue;
        put(x, at, here_volume);
      }
  }
  if (points.count == 0)
    throw InputError(body.polygon ? "corners"
                     : body.disc  ? "centre"
                                  : "origin",
                     "all of the body lies within rigid surfaces: it has no points");
  // solid depths are measured at the loosest density the law knows by name, else as filled
  points.rho_0 = points[F::rho][points.count - 1];
  for (std::size_t k = 0; k < points.material->law().parameters.size(); ++k)
    if (points.material->law().parameters[k].name == "rho_0")
      points.rho_0 = points.material->theta()[k];
  return points;
}

template PointsOf<2> fill<2>(const Body&, const Scene&, std::int64_t);
template PointsOf<3> fill<3>(const Body&, const Scene&, std::int64_t);
template void add_point<2>(PointsOf<2>&, const std::array<double, 2>&, const std::array<double, 2>&,
                           double, const InitialPoint&, double, std::int64_t);
template void add_point<3>(PointsOf<3>&, const std::array<double, 3>&, const std::array<double, 3>&,
                           double, const InitialPoint&, double, std::int64_t);

}  // namespace repose::mpm
