#include "mpm/output/frame_fields.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

namespace repose::mpm {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

double parameter_or_nan(const LawSpec& spec, std::string_view name) {
  const auto table = find_law(spec).parameters;
  const auto found = std::find_if(table.begin(), table.end(), [&](const ParamInfo& parameter) {
    return parameter.name == name;
  });
  if (found == table.end()) return none;
  return checked_parameters(spec)[static_cast<std::size_t>(found - table.begin())];
}

/// A field's name with its unit as a part of it: p_c_Pa, rho_sep_kg_per_m3. Laws from outside have
/// any unit, of which letters and digits stay.
std::string field_name(const StateField& field) {
  std::string name(field.name);
  if (field.unit.empty() || field.unit == "-") return name;
  name += '_';
  for (std::size_t i = 0; i < field.unit.size(); ++i) {
    const std::string_view rest = field.unit.substr(i);
    const auto c = static_cast<unsigned char>(field.unit[i]);
    if (rest.starts_with("²") || rest.starts_with("³")) {
      name += rest.starts_with("²") ? '2' : '3';
      ++i;
    } else if (c == '/') {
      name += "_per_";
    } else {
      name += std::isalnum(c) != 0 ? static_cast<char>(c) : '_';
    }
  }
  return name;
}

}  // namespace

FrameFields::FrameFields(const Simulation& start) {
  for (const Body& body : start.scene().bodies)
    grains_.push_back({parameter_or_nan(body.law, "d"), parameter_or_nan(body.law, "rho_p")});
  // the points' numbers are 0, 1, 2 … as long as none has left
  Simulation::Snapshot shot = start.snapshot();
  x_ = std::move(shot.x_m);
  y_ = std::move(shot.y_m);
  z_ = std::move(shot.z_m);
  density_ = std::move(shot.density);
}

io::FrameView FrameFields::view(const Simulation::Snapshot& shot, double time_s) {
  const std::size_t n = shot.id.size();
  for (std::vector<double>* const values :
       {&dx_, &dy_, &volume_strain_, &specific_volume_, &inertial_number_})
    values->assign(n, none);
  dz_.resize(shot.z_m.size());
  point_.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const auto id = static_cast<std::size_t>(shot.id[k]);
    const auto [d, rho_p] = grains_[static_cast<std::size_t>(shot.body[k])];
    dx_[k] = shot.x_m[k] - x_[id];
    dy_[k] = shot.y_m[k] - y_[id];
    if (!dz_.empty()) dz_[k] = shot.z_m[k] - z_[id];
    volume_strain_[k] = std::log(shot.density[k] / density_[id]);
    specific_volume_[k] = rho_p / shot.density[k];
    if (shot.pressure_Pa[k] > 0.0)
      inertial_number_[k] = shot.shear_rate[k] * d / std::sqrt(shot.pressure_Pa[k] / rho_p);
    point_[k] = static_cast<std::int32_t>(id);
  }

  io::FrameView frame = shot.view(time_s);
  frame.scalars.push_back({"shear_rate_per_s", shot.shear_rate});
  if (!shot.shear_strain.empty()) frame.scalars.push_back({"shear_strain", shot.shear_strain});
  frame.scalars.push_back({"volume_strain", volume_strain_});
  const auto has = [](double x) { return !std::isnan(x); };
  if (std::any_of(grains_.begin(), grains_.end(), [&](const Grains& g) { return has(g.rho_p); }))
    frame.scalars.push_back({"specific_volume", specific_volume_});
  if (std::any_of(grains_.begin(), grains_.end(),
                  [&](const Grains& g) { return has(g.d) && has(g.rho_p); }))
    frame.scalars.push_back({"inertial_number", inertial_number_});
  for (const auto& variable : shot.state)
    frame.scalars.push_back({field_name(*variable.field), variable.values});
  frame.vectors.push_back({"displacement_m", dx_, dy_, dz_});
  frame.integers.push_back({"point", point_});
  return frame;
}

}  // namespace repose::mpm
