#include "mpm/scene/fill.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

#include <fmt/format.h>

#include "mpm/scene/cut_body.hpp"
#include "mpm/scene/restitution.hpp"
#include "mpm/scene/spans.hpp"

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

/// The weight upon the places of a body: of what stands over them without a gap, from the place up
/// to a free surface or to what is rigid and bears the rest.
class Overburden {
 public:
  /// `spacing`: of the body's points along y.
  Overburden(const Scene& scene, const Body& body, double g, double spacing)
      : scene_(scene),
        surfaces_(rigid_surfaces(scene)),
        body_(body),
        g_(g),
        spacing_(spacing) {}

  /// The vertical stress at a place of the body; z counts in space only.
  double at(const Material& material, double x, double y, double z) {
    const auto own = static_cast<std::size_t>(&body_ - scene_.bodies.data());
    Part part{own, {y, y}};
    for (const Span& span : spans_over(scene_, body_, x, z))
      if (y >= span.low - gap() && y <= span.high + gap()) part.span = {y, span.high};
    std::vector<Part> stack;
    bool borne = cut(part.span, x, z);
    const Span span = part.span;
    while (!borne && upon(x, z, part)) {
      borne = cut(part.span, x, z);
      stack.push_back(part);
    }
    double above = 0.0;
    if (!stack.empty()) {
      const auto [place, is_new] = known_.try_emplace(stack, 0.0);
      if (is_new)
        for (std::size_t i = stack.size(); i-- > 0;) place->second = below(stack[i], place->second);
      above = place->second;
    }
    if (span.low != last_.span.low || span.high != last_.span.high || above != last_.above)
      last_ = {span, above, column(material, body_, span, above)};
    return last_.stress;
  }

 private:
  struct Part {
    std::size_t body = 0;
    Span span;
    friend bool operator<(const Part& a, const Part& b) {
      return std::tie(a.body, a.span.low, a.span.high) < std::tie(b.body, b.span.low, b.span.high);
    }
  };
  double gap() const { return 0.5 * spacing_; }

  /// Goes on to the part of a body whose base stands on the top of `part`.
  bool upon(double x, double z, Part& part) const {
    const double top = part.span.high;
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i)
      for (const Span& span : spans_over(scene_, scene_.bodies[i], x, z)) {
        if (scene_.bodies[i].disc && scene_.dimensions() == 2) continue;  // it touches in a point
        const bool itself = i == part.body && span.high <= top;
        if (itself || std::abs(span.low - top) > gap()) continue;
        part = {i, span};
        return true;
      }
    return false;
  }

  /// Ends a span where a rigid surface begins. Returns whether one does.
  bool cut(Span& span, double x, double z) const {
    if (surfaces_.empty()) return false;
    const auto rigid = [&](double y) {
      return std::any_of(surfaces_.begin(), surfaces_.end(), [&](const Surface& s) {
        return s.holds_at(0.0, {x, y, z});
      });
    };
    const int steps = static_cast<int>(std::ceil((span.high - span.low) / gap()));
    for (int k = 1; k <= steps; ++k) {
      const double y = span.low + (span.high - span.low) * k / steps;
      if (!rigid(y)) continue;
      double free = span.low + (span.high - span.low) * (k - 1) / steps, held = y;
      for (int halving = 0; halving < 40; ++halving) {
        const double middle = 0.5 * (free + held);
        (rigid(middle) ? held : free) = middle;
      }
      span.high = free;
      return true;
    }
    return false;
  }

  /// The vertical stress at the lower end of a part of a body that carries `above`.
  double column(const Material& material, const Body& body, const Span& span, double above) const {
    const double wet_top = std::clamp(scene_.water_table.value_or(span.low), span.low, span.high);
    const double dry = dry_column(material, body, g_, span.high - wet_top, above);
    if (wet_top == span.low) return dry;
    return dry_column(material, body, g_ * (1.0 - buoyant_share(scene_, material)),
                      wet_top - span.low, dry);
  }

  /// The same over a depth under one gravity.
  double dry_column(const Material& material, const Body& body, double g, double depth,
                    double above) const {
    if (!body.lithostatic) return above + g * material.initial(body.initial).density * depth;
    // steps of a quarter spacing: the error of the fourth-order rule is far below round-off of σ
    const int steps = static_cast<int>(std::ceil(depth / (0.25 * spacing_)));
    return overburden(material, body.initial.ocr.value_or(1.0), body.initial.K0.value_or(1.0), g,
                      depth, steps, above);
  }

  /// The vertical stress below a part that carries `above`.
  double below(const Part& part, double above) const {
    try {
      const Body& body = scene_.bodies[part.body];
      return column(*make_material(body.law), body, part.span, above);
    } catch (const InputError& e) {
      throw InputError("lithostatic", "body[" + std::to_string(part.body) +
                                          "], which stands on this one: " + e.what());
    }
  }

  const Scene& scene_;
  std::vector<Surface> surfaces_;
  const Body& body_;
  double g_, spacing_;
  std::map<std::vector<Part>, double> known_;
  struct {  // along a row of a box they are the same
    Span span;
    double above = std::numeric_limits<double>::quiet_NaN(), stress = 0.0;
  } last_;
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

double buoyant_share(const Scene& scene, const Material& material) {
  if (!scene.water_table) return 0.0;
  for (const std::string_view name : {"rho_p", "rho_0"})
    for (const ParamInfo& parameter : material.law().parameters)
      if (parameter.name == name) return scene.water_density / material.parameter(name);
  throw InputError("law.name", fmt::format("{} has no density of its grains (rho_p) nor one to "
                                           "start from (rho_0): below a water table its buoyancy "
                                           "is not known",
                                           material.law().name));
}

template <int dim>
PointsOf<dim> without_points(const Body& body, const Scene& scene) {
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
  return points;
}

template <int dim>
PointsOf<dim> fill(const Body& body, const Scene& scene, std::int64_t first_id) {
  PointsOf<dim> points = without_points<dim>(body, scene);
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
  const bool in_rows = !body.release && (!is_cut(body) || is_plain_polygon(body));
  if (in_rows) points.reserve(static_cast<std::size_t>(lattice[0] * lattice[1] * lattice[2]));
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
  Overburden weight(scene, body, g, spacing[1]);
  /// The state under a vertical stress.
  const auto under = [&](double vertical) {
    InitialConditions here = body.initial;
    here.p = vertical * (1.0 + 2.0 * K0) / 3.0;
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
          put(place,
              body.lithostatic
                  ? under(within("initial",
                                 [&] { return weight.at(*points.material, x, place[1], z); }))
                  : uniform,
              of_column / static_cast<double>(count));
        }
      }
  }
  if (!body.release && !in_rows) {
    const std::vector<Share> shares = shares_of(scene, body);
    points.reserve(shares.size());
    for (const Share& share : shares) {
      const Position centroid = share.centroid();
      std::array<double, dim> x;
      for (std::size_t m = 0; m < dim; ++m) x[m] = centroid[m];
      if (behind_a_surface<dim>(surfaces, x)) continue;
      const auto vertical = [&] { return weight.at(*points.material, x[0], x[1], centroid[2]); };
      put(x, body.lithostatic ? under(within("initial", vertical)) : uniform, share.volume);
    }
  }
  for (std::int64_t j = 0; in_rows && j < lattice[1]; ++j) {
    const double y = coordinate(1, j);
    InitialPoint at = uniform;
    double known = std::numeric_limits<double>::quiet_NaN();  // of which `at` is made
    for (std::int64_t k = 0; k < lattice[2]; ++k)
      for (std::int64_t i = 0; i < lattice[0]; ++i) {
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
        if (body.lithostatic) {
          const double vertical = within("initial", [&] {
            return weight.at(*points.material, x[0], x[1], dim == 3 ? x[dim - 1] : 0.0);
          });
          if (vertical != known) {
            at = under(vertical);
            known = vertical;
          }
        }
        put(x, at, here_volume);
      }
  }
  if (points.count == 0)
    throw InputError(body.solid     ? "shape"
                     : body.polygon ? "corners"
                     : body.disc    ? "centre"
                                    : "origin",
                     "all of the body lies within rigid surfaces: it has no points");
  // solid depths are measured at the loosest density the law knows by name, else as filled
  points.rho_0 = points[Layout<dim>::rho][points.count - 1];
  for (std::size_t k = 0; k < points.material->law().parameters.size(); ++k)
    if (points.material->law().parameters[k].name == "rho_0")
      points.rho_0 = points.material->theta()[k];
  return points;
}

template PointsOf<2> without_points<2>(const Body&, const Scene&);
template PointsOf<3> without_points<3>(const Body&, const Scene&);
template PointsOf<2> fill<2>(const Body&, const Scene&, std::int64_t);
template PointsOf<3> fill<3>(const Body&, const Scene&, std::int64_t);
template void add_point<2>(PointsOf<2>&, const std::array<double, 2>&, const std::array<double, 2>&,
                           double, const InitialPoint&, double, std::int64_t);
template void add_point<3>(PointsOf<3>&, const std::array<double, 3>&, const std::array<double, 3>&,
                           double, const InitialPoint&, double, std::int64_t);

}  // namespace repose::mpm
