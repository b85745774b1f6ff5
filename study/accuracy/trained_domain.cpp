#include "study/accuracy/trained_domain.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/core.h>

namespace repose::study {
namespace {

/// What a parameter is compared with, of a scene of height H whose material weighs ρgH: itself, its
/// share of H, of ρgH or of ρ√(gH) H.
enum class Unit { itself, height, weight, inertia };

struct Between {
  std::string_view parameter;
  double lower, upper;
  Unit unit = Unit::itself;
};

/// The charted scenes of a form of a law: scripts/accuracy, training_scenes().
struct Trained {
  std::string_view law, form;
  double longest_time;                  ///< end time over √(H/g)
  double least_aspect, largest_aspect;  ///< H over the width
  double steepest_tilt;                 ///< [degrees]
  std::span<const Between> parameters;
};

constexpr std::array mu_i_parameters{
    Between{"mu_0", 0.2, 0.6}, Between{"mu_d", 0.4, 0.8}, Between{"I_0", 0.15, 0.558},
    Between{"d", 0.0053 / 0.4, 0.02 / 0.4, Unit::height},
    Between{"K", 26000.0 / (1300.0 * 9.8 * 0.4), 254800.0 / (1300.0 * 9.8 * 0.2), Unit::weight}};
// √(9.8 × 0.4) = 1.98, √(9.8 × 0.2) = 1.4: water of the paper's column to honey of half its height
constexpr std::array newtonian_parameters{
    Between{"eta", 0.002 / (1300.0 * 1.98 * 0.4), 5.0 / (1300.0 * 1.4 * 0.2), Unit::inertia},
    Between{"K", 26000.0 / (1300.0 * 9.8 * 0.4), 26000.0 / (1300.0 * 9.8 * 0.2), Unit::weight},
    Between{"alpha", 7.0, 7.0}};
constexpr std::array cam_clay_parameters{
    Between{"M", 0.6614, 1.1}, Between{"lambda", 0.0186, 0.0186}, Between{"kappa", 0.001, 0.001},
    Between{"nu", 0.3, 0.3},   Between{"Gamma", 1.5432, 1.5432},  Between{"p_ref", 1.0, 1.0}};
constexpr std::array trained{
    Trained{"mu_i", "elastoviscoplastic", 3.0, 0.5, 4.0, 35.0, mu_i_parameters},
    Trained{"newtonian", "true", 2.1, 0.66, 2.0, 20.0, newtonian_parameters},
    Trained{"modified_cam_clay", "ln_v-ln_p", 2.3, 1.0, 2.0, 20.0, cam_clay_parameters}};

const Trained* find_trained(const LawInfo& info) {
  const auto found = std::find_if(trained.begin(), trained.end(), [&](const Trained& t) {
    return t.law == info.name && t.form == info.option;
  });
  return found == trained.end() ? nullptr : &*found;
}

bool is_between(double x, double lower, double upper) {
  return x >= 0.99 * lower && x <= 1.01 * upper;
}

double unit_of(Unit unit, double density, double gravity, double height) {
  switch (unit) {
    case Unit::height:
      return height;
    case Unit::weight:
      return density * gravity * height;
    case Unit::inertia:
      return density * std::sqrt(gravity * height) * height;
    case Unit::itself:
      break;
  }
  return 1.0;
}

void compare_body(const mpm::Scene& scene, const mpm::Body& body,
                  std::vector<std::string>& reasons) {
  const LawInfo& info = find_law(body.law);
  const Trained* const found = find_trained(info);
  if (found == nullptr) {
    const std::string form(info.option);
    reasons.push_back(form.empty() ? std::string(info.name)
                                   : fmt::format("{} of the form {}", info.name, form));
    return;
  }
  if (const auto shape = body.law.values.find("shape");
      shape != body.law.values.end() && shape->second != 0.0)
    reasons.emplace_back("a cone of friction that is no circle");
  const double height = body.size[1];
  const auto outside = [&](std::string_view what, double x, double lower, double upper) {
    if (!is_between(x, lower, upper))
      reasons.push_back(
          fmt::format("{} of {:.3g} (shown: {:.3g} to {:.3g})", what, x, lower, upper));
  };
  if (scene.gravity > 0.0)
    outside("an end time over sqrt(H/g)", scene.end_time / std::sqrt(height / scene.gravity), 0.0,
            found->longest_time);
  else
    reasons.emplace_back("no gravity");
  outside("a height over width", height / body.size[0], found->least_aspect, found->largest_aspect);
  if (scene.tilt_deg < 0.0 || scene.tilt_deg > found->steepest_tilt)
    reasons.push_back(fmt::format("a tilt of {:g} degrees (shown: 0 to {:g})", scene.tilt_deg,
                                  found->steepest_tilt));
  const auto material = make_material(body.law);
  for (const Between& range : found->parameters) {
    const double unit =
        range.unit == Unit::itself
            ? 1.0
            : unit_of(range.unit, material->density_at(0.0, 1.0), scene.gravity, height);
    if (!(unit > 0.0)) continue;
    constexpr std::array<std::string_view, 4> per{"", " over H", " over rho g H",
                                                  " over rho sqrt(g H) H"};
    outside(fmt::format("{}{}", range.parameter, per[static_cast<std::size_t>(range.unit)]),
            material->parameter(range.parameter) / unit, range.lower, range.upper);
  }
}

struct Row {
  std::string_view law, form;
  Quantity quantity;
  double target;
  int answers, held;
};

// printed by `scripts/accuracy rehearse`
constexpr std::array rows{
#include "study/accuracy/rehearsed_rows.inc"
};

}  // namespace

bool is_charted(const LawSpec& law) { return find_trained(find_law(law)) != nullptr; }

std::vector<std::string> beyond_training(const mpm::Scene& scene) {
  std::vector<std::string> reasons;
  if (scene.dimensions() != 2) reasons.emplace_back("a scene in space");
  if (scene.water_table) reasons.emplace_back("a water table");
  if (scene.gravity_ramp > 0.0) reasons.emplace_back("gravity that grows");
  if (!scene.start_from.empty()) reasons.emplace_back("points of another run");
  if (scene.bodies.size() != 1) {
    reasons.push_back(fmt::format("{} bodies", scene.bodies.size()));
    return reasons;
  }
  const mpm::Body& body = scene.bodies.front();
  if (body.disc) reasons.emplace_back("a round body");
  if (body.polygon) reasons.emplace_back("a body cut to a polygon");
  if (is_cut(body) && !body.polygon) reasons.emplace_back("a body cut by a surface");
  if (!scene.inflows.empty()) reasons.emplace_back("material that comes in");
  if (!scene.surfaces.empty()) reasons.emplace_back("rigid surfaces");
  if (body.origin[0] > 0.0 || body.origin[1] > 0.0)
    reasons.emplace_back("a body away from the left wall or the floor");
  if (body.velocity != std::array<double, 3>{} || body.spin != 0.0)
    reasons.emplace_back("a body that moves at the start");
  if (body.initial.ocr.value_or(1.0) > 1.01) reasons.emplace_back("an overconsolidated start");
  if (scene.relaxation_time) reasons.emplace_back("a relaxation time of its own");
  if (body.lithostatic) reasons.emplace_back("a lithostatic start");
  if (body.restitution) reasons.emplace_back("contacts that damp");
  using Kind = mpm::Wall::Kind;
  if (scene.floor.kind == Kind::friction)  // its charts were made before its impulses were whole
    reasons.emplace_back("a floor with friction");
  else if (scene.floor.kind == Kind::parts)
    reasons.emplace_back("a floor in parts");
  else if (scene.floor.kind != Kind::no_slip)
    reasons.emplace_back("a floor that is not no-slip");
  if (scene.floor.speed != 0.0) reasons.emplace_back("a floor that moves");
  if (scene.left.kind != Kind::slip || scene.right.kind != Kind::slip ||
      scene.top.kind != Kind::slip)
    reasons.emplace_back("walls other than slip");
  if (scene.points_per_cell != mpm::Scene{}.points_per_cell)
    reasons.push_back(fmt::format("{} points per cell", scene.points_per_cell));
  if (scene.viscosity != mpm::Viscosity::explicit_force)
    reasons.emplace_back("an implicit viscosity");
  compare_body(scene, body, reasons);
  return reasons;
}

std::optional<Rehearsed> rehearsed(std::string_view law, std::string_view form, Quantity q,
                                   double target) {
  const Row* best = nullptr;
  for (const Row& row : rows)
    if (row.law == law && row.form == form && row.quantity == q && row.target <= target &&
        (best == nullptr || row.target > best->target))
      best = &row;
  if (best == nullptr) return {};
  return Rehearsed{best->answers, best->held};
}

}  // namespace repose::study
