#include "pointdriver/path/laboratory.hpp"

#include "models/parameter.hpp"

namespace repose::point {
namespace {

constexpr int xx = 0, yy = 1, zz = 2, xy = 3, yz = 4, zx = 5;

/// σ̇_a − σ̇_r = rate
Constraint deviator_rate(double rate) {
  Constraint row;
  row.stress[yy] = 1.0;
  row.stress[xx] = row.stress[zz] = -0.5;
  row.rate = rate;
  return row;
}

Constraint mean_stress_rate(double rate) {
  Constraint row;
  row.stress[xx] = row.stress[yy] = row.stress[zz] = 1.0 / 3.0;
  row.rate = rate;
  return row;
}

Constraint volume_rate(double rate) {
  Constraint row;
  row.strain[xx] = row.strain[yy] = row.strain[zz] = 1.0;
  row.rate = rate;
  return row;
}

Constraint radial_stress_rate(double weight, double rate) {
  Constraint row;
  row.stress[xx] = row.stress[zz] = 0.5 * weight;
  row.rate = rate;
  return row;
}

[[noreturn]] void no_such_test(const Stage& stage, const std::string& why) {
  throw InputError("kind", std::string(name_of(stage.kind)) + ": " + why);
}

bool reaches(const Stage& stage, std::initializer_list<Quantity> list) {
  return stage.goal && std::find(list.begin(), list.end(), stage.goal->quantity) != list.end();
}

/// Rows 0 to 3 of everything with an axis: no shear, equal radial strains.
void axisymmetric_rows(std::array<Constraint, 6>& rows) {
  rows[0] = strain_rate(xy, 0.0);
  rows[1] = strain_rate(yz, 0.0);
  rows[2] = strain_rate(zx, 0.0);
  rows[3] = equal_strain(xx, zz);
}

/// The driver row, and whether it leads to the goal at its own rate.
struct Driver {
  Constraint row;
  bool leads = false;
};

Driver triaxial_driver(const Stage& stage) {
  if (stage.drive == Drive::strain)
    return {strain_rate(yy, stage.rate), reaches(stage, {Quantity::eps_a})};
  const double rate = stage.drive == Drive::creep ? 0.0 : stage.stress_rate;
  switch (stage.condition) {
    case Condition::drained:
      return {stress_rate(yy, rate), reaches(stage, {Quantity::q, Quantity::sigma_a})};
    case Condition::undrained:
    case Condition::constant_p:
      return {deviator_rate(rate), reaches(stage, {Quantity::q})};
    case Condition::constant_sigma_a:
      return {radial_stress_rate(-1.0, rate), reaches(stage, {Quantity::q})};
    default:
      no_such_test(stage, "drainage must be drained, undrained, constant_p or constant_sigma_a");
  }
}

Constraint triaxial_condition(const Stage& stage) {
  switch (stage.condition) {
    case Condition::drained:
      return radial_stress_rate(1.0, 0.0);
    case Condition::undrained:
      return volume_rate(0.0);
    case Condition::constant_p:
      return mean_stress_rate(0.0);
    case Condition::constant_sigma_a:
      return stress_rate(yy, 0.0);
    default:
      no_such_test(stage, "drainage must be drained, undrained, constant_p or constant_sigma_a");
  }
}

Constraint shear_condition(const Stage& stage) {
  switch (stage.condition) {
    case Condition::constant_volume:
      return strain_rate(yy, 0.0);
    case Condition::constant_normal_stress:
      return stress_rate(yy, 0.0);
    case Condition::constant_p:
      return mean_stress_rate(0.0);
    default:
      no_such_test(stage, "drainage must be constant_volume, constant_normal_stress or constant_p");
  }
}

Driver driver_of(const Stage& stage, std::array<Constraint, 6>& rows) {
  const bool by_strain = stage.drive == Drive::strain;
  const double stress = stage.drive == Drive::creep ? 0.0 : stage.stress_rate;
  switch (stage.kind) {
    case Kind::triaxial:
      axisymmetric_rows(rows);
      rows[4] = triaxial_condition(stage);
      return triaxial_driver(stage);
    case Kind::isotropic:
      axisymmetric_rows(rows);
      rows[4] = deviator_rate(0.0);
      return by_strain ? Driver{volume_rate(stage.rate), reaches(stage, {Quantity::eps_v})}
                       : Driver{mean_stress_rate(stress), reaches(stage, {Quantity::p})};
    case Kind::oedometer:
      rows[0] = strain_rate(xy, 0.0);
      rows[1] = strain_rate(yz, 0.0);
      rows[2] = strain_rate(zx, 0.0);
      rows[3] = strain_rate(xx, 0.0);
      rows[4] = strain_rate(zz, 0.0);
      return by_strain ? Driver{strain_rate(yy, stage.rate),
                                reaches(stage, {Quantity::eps_a, Quantity::eps_v})}
                       : Driver{stress_rate(yy, stress), reaches(stage, {Quantity::sigma_a})};
    case Kind::simple_shear:
      rows[0] = strain_rate(xx, 0.0);
      rows[1] = strain_rate(zz, 0.0);
      rows[2] = strain_rate(yz, 0.0);
      rows[3] = strain_rate(zx, 0.0);
      rows[4] = shear_condition(stage);
      return by_strain
                 ? Driver{strain_rate(xy, 0.5 * stage.rate), reaches(stage, {Quantity::gamma})}
                 : Driver{stress_rate(xy, stress), reaches(stage, {Quantity::tau})};
    case Kind::custom:
      break;
  }
  no_such_test(stage, "a custom stage lists its own constraints");
}

}  // namespace

std::string_view name_of(Kind kind) {
  constexpr std::array<std::string_view, 5> names{"isotropic", "oedometer", "triaxial",
                                                  "simple_shear", "custom"};
  return names[static_cast<std::size_t>(kind)];
}

std::string_view name_of(Condition condition) {
  constexpr std::array<std::string_view, 6> names{"drained",         "undrained",
                                                  "constant_p",      "constant_sigma_a",
                                                  "constant_volume", "constant_normal_stress"};
  return names[static_cast<std::size_t>(condition)];
}

LegSpec leg_of(const Stage& stage) {
  LegSpec leg;
  leg.points = stage.points;
  leg.stops = stage.stops;
  leg.continues = stage.continues;
  leg.kind = stage.kind;
  leg.condition = stage.condition;
  leg.name = name_of(stage.kind);
  if (stage.kind == Kind::triaxial || stage.kind == Kind::simple_shear)
    leg.name = std::string(name_of(stage.condition)) + " " + leg.name;
  if (stage.drive == Drive::relaxation) {
    for (int i = 0; i < 6; ++i) leg.rows[static_cast<std::size_t>(i)] = strain_rate(i, 0.0);
    leg.duration = stage.duration;
    leg.name += " relaxation";
    return leg;
  }
  const Driver driver = driver_of(stage, leg.rows);
  leg.rows[5] = driver.row;
  if (stage.drive == Drive::creep) {
    leg.duration = stage.duration;
    leg.name += " creep";
    return leg;
  }
  if (!stage.goal) no_such_test(stage, "a stage needs a value to reach (axial_strain, q_end, ...)");
  leg.driver = 5;
  // compression at constant σ_a, or constant p, lowers σ_r; so does the stress that drives both
  leg.goal_falls =
      stage.kind == Kind::triaxial && reaches(stage, {Quantity::sigma_r}) &&
      (stage.condition == Condition::constant_sigma_a || stage.condition == Condition::constant_p);
  leg.goal = stage.goal;
  leg.goal_is_event = !driver.leads;
  leg.goal_rate = stage.drive == Drive::strain ? stage.rate : stage.stress_rate;
  leg.strain_limit = stage.drive == Drive::strain ? stage.strain_limit
                                                  : 1e12;  // stress driven: bounded by max_strain
  return leg;
}

Path path_of(const std::vector<Stage>& stages) {
  if (stages.empty()) throw InputError("stages", "a test needs at least one stage");
  Path path;
  bool axisymmetric = false, shear = false;
  for (const Stage& stage : stages) {
    path.legs.emplace_back(leg_of(stage));
    if (stage.kind == Kind::simple_shear)
      shear = true;
    else
      axisymmetric = true;
    if (!path.undrained && stage.kind == Kind::triaxial &&
        stage.condition == Condition::undrained) {
      path.undrained = true;
      path.first_undrained = static_cast<int>(path.legs.size()) - 1;
    }
  }
  path.frame = shear ? Frame::shear : Frame::axisymmetric;
  path.needs_axisymmetry = axisymmetric;
  path.wants_strain_rate = shear;
  return path;
}

std::vector<Stage> cycles(const Stage& half, Quantity quantity, double lower, double upper, int n,
                          bool of_stage) {
  if (n < 1 || n > 10000) throw InputError("cycles", "cycles must be from 1 to 10000");
  if (!(lower < upper))
    throw InputError("cycles", "the lower limit of a cycle must be < the upper");
  std::vector<Stage> stages;
  for (int i = 0; i < n; ++i)
    for (const double limit : {upper, lower}) {
      Stage stage = half;
      stage.goal = Goal{quantity, limit, of_stage};
      stage.continues = !stages.empty();
      stages.push_back(stage);
    }
  return stages;
}

std::vector<Stage> rate_sweep(Stage shear, double slowest, double fastest, int count,
                              double shear_strain) {
  if (count < 1 || count > 100000) throw InputError("rates", "count must be from 1 to 100000");
  if (!(slowest > 0.0 && fastest >= slowest && std::isfinite(fastest)))
    throw InputError("rates", "rates must run from a slowest > 0 to a fastest >= it, in 1/s");
  std::vector<Stage> stages;
  for (int i = 0; i < count; ++i) {
    const double share = count > 1 ? static_cast<double>(i) / (count - 1) : 0.0;
    shear.rate = slowest * std::pow(fastest / slowest, share);
    shear.goal = Goal{Quantity::gamma, (i + 1) * shear_strain};
    shear.points = 1;
    stages.push_back(shear);
  }
  return stages;
}

Path custom_path(std::vector<LegSpec> legs) {
  if (legs.empty()) throw InputError("stages", "a custom test needs at least one stage");
  Path path;
  path.frame = Frame::general;
  path.wants_strain_rate = true;
  for (LegSpec& leg : legs) {
    if (leg.name.empty()) leg.name = "custom";
    path.legs.emplace_back(std::move(leg));
  }
  return path;
}

}  // namespace repose::point
