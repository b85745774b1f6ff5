#include "study/run/run_record.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <fstream>
#include <utility>

#include <sys/resource.h>

#include "io/json.hpp"
#include "models/instruction_set.hpp"
#include "repose_version.hpp"

namespace repose::study {
namespace {

using Json = io::Json;

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

Json to_json(const toml::node& node) {
  if (const toml::table* table = node.as_table()) {
    Json object = Json::object();
    for (const auto& [key, child] : *table) object[std::string(key.str())] = to_json(child);
    return object;
  }
  if (const toml::array* list = node.as_array()) {
    Json values = Json::array();
    for (const toml::node& child : *list) values.push_back(to_json(child));
    return values;
  }
  if (const auto* value = node.as_integer()) return value->get();
  if (const auto* value = node.as_floating_point()) return value->get();
  if (const auto* value = node.as_boolean()) return value->get();
  if (const auto* value = node.as_string()) return value->get();
  return {};
}

}  // namespace

std::string named(std::string_view name, std::size_t dimensions) {
  const std::string_view per_metre = "_per_m";
  if (dimensions == 3 && name.ends_with(per_metre)) name.remove_suffix(per_metre.size());
  return std::string(name);
}

namespace {

using Extent = mpm::Simulation::FlowExtent;
/// What a flow over a terrain has beside what all runs have.
constexpr std::array<std::pair<const char*, double Extent::*>, 8> extent_columns{
    {{"runout_99_m", &Extent::runout_99_m},
     {"runout_max_m", &Extent::runout_max_m},
     {"area_m2", &Extent::area_m2},
     {"reached_m2", &Extent::reached_m2},
     {"depth_mean_m", &Extent::depth_mean_m},
     {"depth_max_m", &Extent::depth_max_m},
     {"speed_mean_m_per_s", &Extent::speed_mean},
     {"speed_max_m_per_s", &Extent::speed_max}}};

}  // namespace

std::vector<std::string> series_columns(const mpm::Scene& scene) {
  const std::size_t dimensions = scene.dimensions();
  std::vector<std::string> columns{"time_s",
                                   "step",
                                   "dt_s",
                                   "front_m",
                                   "front_max_m",
                                   "height_m",
                                   "kinetic_J_per_m",
                                   "potential_J_per_m",
                                   "elastic_J_per_m",
                                   "dissipated_J_per_m",
                                   "mass_kg_per_m",
                                   "momentum_x",
                                   "momentum_y",
                                   "density_min",
                                   "density_max",
                                   "points_separated",
                                   "transfer_loss_J_per_m",
                                   "wall_loss_J_per_m",
                                   "energy_residual_J_per_m",
                                   "outflow_kg_per_m",
                                   "angular_momentum",
                                   "front_99_m",
                                   "plastic_J_per_m",
                                   "viscous_J_per_m",
                                   "hypoelastic_J_per_m",
                                   "separation_J_per_m",
                                   "averaging_loss_J_per_m",
                                   "density_floor_J_per_m",
                                   "work_residual_J_per_m",
                                   "inflow_kg_per_m"};
  if (dimensions == 2) return columns;
  for (std::string& column : columns) column = named(column, dimensions);
  for (std::string& column : columns)
    if (column == "angular_momentum") column += "_z";
  columns.insert(columns.end(), {"angular_momentum_x", "angular_momentum_y", "momentum_z"});
  if (scene.terrain)
    for (const auto& [name, member] : extent_columns) columns.emplace_back(name);
  return columns;
}

std::vector<double> series_values(const mpm::SeriesRow& row, const mpm::Simulation& simulation) {
  std::vector<double> values{row.time_s,
                             static_cast<double>(row.step),
                             row.dt_s,
                             row.front_m,
                             row.front_max_m,
                             row.height_m,
                             row.kinetic_J_per_m,
                             row.potential_J_per_m,
                             row.elastic_J_per_m,
                             row.dissipated_J_per_m,
                             row.mass_kg_per_m,
                             row.momentum_x,
                             row.momentum_y,
                             row.density_min,
                             row.density_max,
                             static_cast<double>(row.points_separated),
                             row.transfer_loss_J_per_m,
                             row.wall_loss_J_per_m,
                             row.energy_residual_J_per_m,
                             row.outflow_kg_per_m,
                             row.angular_momentum,
                             row.front_99_m,
                             row.plastic_J_per_m,
                             row.viscous_J_per_m,
                             row.hypoelastic_J_per_m,
                             row.separation_J_per_m,
                             row.averaging_loss_J_per_m,
                             row.density_floor_J_per_m,
                             row.work_residual_J_per_m,
                             row.inflow_kg_per_m};
  if (simulation.scene().dimensions() == 3)
    values.insert(values.end(), {row.angular_momentum_x, row.angular_momentum_y, row.momentum_z});
  if (simulation.scene().terrain) {
    const Extent extent = simulation.flow_extent();
    for (const auto& [name, member] : extent_columns) values.push_back(extent.*member);
  }
  return values;
}

Usage usage() {
  rusage self{};
  getrusage(RUSAGE_SELF, &self);
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration<double>(now).count(),
          seconds(self.ru_utime) + seconds(self.ru_stime),
          static_cast<double>(self.ru_maxrss) * 1024.0 / 1e6};  // ru_maxrss counts KiB
}

RunRecord::RunRecord(const mpm::Simulation& start)
    : dimensions(start.scene().dimensions()),
      initial_points(start.point_count()) {
  const mpm::SeriesRow row = start.diagnostics();
  initial_potential_J_per_m = row.potential_J_per_m;
  initial_mass_kg_per_m = row.mass_kg_per_m;
  include(row);
}

void RunRecord::include(const mpm::SeriesRow& row) {
  peak_kinetic_J_per_m = std::max(peak_kinetic_J_per_m, row.kinetic_J_per_m);
}

void RunRecord::continue_from(const std::filesystem::path& summary) {
  errno = 0;
  std::ifstream in(summary);
  if (!in) throw io::IoError(summary, "cannot read what the interrupted run noted", errno);
  try {
    const Json noted = Json::parse(std::string(std::istreambuf_iterator<char>(in), {}));
    peak_kinetic_J_per_m = std::max(
        peak_kinetic_J_per_m, noted.at(named("peak_kinetic_J_per_m", dimensions)).get<double>());
    wall_s = noted.at("wall_s").get<double>();
    cpu_s = noted.at("cpu_s").get<double>();
    sessions = noted.at("sessions").get<int>() + 1;
  } catch (const Json::Error& error) {
    throw io::IoError(summary, std::string("is not the summary of a run: ") + error.what());
  }
}

std::string noted_status(const std::filesystem::path& summary) {
  std::ifstream in(summary);
  const auto noted = Json::try_parse(std::string(std::istreambuf_iterator<char>(in), {}));
  const Json* status = noted ? noted->find("status") : nullptr;
  return status && status->is_string() ? status->get<std::string>() : "";
}

double RunRecord::energy_error(const mpm::SeriesRow& last) const {
  const double scale =
      std::max(initial_potential_J_per_m - last.potential_J_per_m, peak_kinetic_J_per_m);
  const double residual = std::abs(last.energy_residual_J_per_m);
  return residual == 0.0 ? 0.0 : residual / scale;
}

std::int64_t RunRecord::lost_points(std::int64_t present, const mpm::SeriesRow& last) const {
  // What has left through an open edge, or come in, is known by its mass: a quarter of a point is
  // far above the round-off of the sums, and below the mass of any whole point.
  const double missing =
      initial_mass_kg_per_m + last.inflow_kg_per_m - last.mass_kg_per_m - last.outflow_kg_per_m;
  const double point = initial_mass_kg_per_m / static_cast<double>(initial_points);
  const bool accounted =
      last.outflow_kg_per_m + last.inflow_kg_per_m > 0.0 && std::abs(missing) < 0.25 * point;
  return accounted ? 0 : initial_points - present;
}

std::string summary_text(const RunFacts& facts, const RunRecord& record,
                         const mpm::Simulation& simulation, const Usage& spent) {
  const mpm::SeriesRow last = simulation.diagnostics();
  const mpm::Simulation::Counters counters = simulation.counters();
  const double wall = record.wall_s + spent.wall_s;
  Json s;
  const auto put = [&](const char* name, double x) { s[named(name, record.dimensions)] = x; };
  s["repose"] = version_string;
  s["instruction_set"] = instruction_set();
  s["status"] = facts.status;
  if (!facts.reason.empty()) s["reason"] = facts.reason;
  s["name"] = simulation.scene().name;
  s["seed"] = facts.seed;
  s["points"] = record.initial_points;
  s["lost_points"] = record.lost_points(simulation.point_count(), last);
  s["steps"] = last.step;
  s["time_s"] = last.time_s;
  s["dt_min_s"] = counters.dt_min_s;
  s["dt_max_s"] = counters.dt_max_s;
  s["front_m"] = last.front_m;
  s["front_99_m"] = last.front_99_m;
  s["front_max_m"] = last.front_max_m;
  s["height_m"] = last.height_m;
  s["density_min"] = last.density_min;
  s["density_max"] = last.density_max;
  s["points_separated"] = last.points_separated;
  put("mass_kg_per_m", last.mass_kg_per_m);
  s["mass_error"] = (last.mass_kg_per_m + last.outflow_kg_per_m) /
                        (record.initial_mass_kg_per_m + last.inflow_kg_per_m) -
                    1.0;
  put("outflow_kg_per_m", last.outflow_kg_per_m);
  if (!simulation.scene().inflows.empty()) put("inflow_kg_per_m", last.inflow_kg_per_m);
  put("kinetic_J_per_m", last.kinetic_J_per_m);
  put("peak_kinetic_J_per_m", record.peak_kinetic_J_per_m);
  put("potential_drop_J_per_m", record.initial_potential_J_per_m - last.potential_J_per_m);
  s["angular_momentum"] = last.angular_momentum;
  put("elastic_J_per_m", last.elastic_J_per_m);
  put("dissipated_J_per_m", last.dissipated_J_per_m);
  put("plastic_J_per_m", last.plastic_J_per_m);
  put("viscous_J_per_m", last.viscous_J_per_m);
  put("hypoelastic_J_per_m", last.hypoelastic_J_per_m);
  put("separation_J_per_m", last.separation_J_per_m);
  put("averaging_loss_J_per_m", last.averaging_loss_J_per_m);
  put("density_floor_J_per_m", last.density_floor_J_per_m);
  put("transfer_loss_J_per_m", last.transfer_loss_J_per_m);
  put("wall_loss_J_per_m", last.wall_loss_J_per_m);
  if (!simulation.scene().surfaces.empty()) put("surface_work_J_per_m", counters.surface_work);
  put("energy_residual_J_per_m", last.energy_residual_J_per_m);
  put("work_residual_J_per_m", last.work_residual_J_per_m);
  s["energy_error"] = record.energy_error(last);
  s["wall_s"] = wall;
  s["cpu_s"] = record.cpu_s + spent.cpu_s;
  s["point_steps_per_s"] = static_cast<double>(simulation.point_steps()) / wall;
  s["threads"] = counters.threads;
  s["state_memory_MB"] = counters.memory_MB;
  s["peak_memory_MB"] = spent.peak_memory_MB;
  s["wall_corrections"] = counters.wall_corrections;
  s["sorts"] = counters.sorts;
  s["points_at_density_floor"] = counters.points_held;
  s["points_at_density_floor_max"] = counters.most_points_held;
  s["point_steps_at_density_floor"] = counters.point_steps_held;
  if (simulation.scene().viscosity == mpm::Viscosity::implicit_solve) {
    s["newton_iterations"] = counters.newton_iterations;
    s["cg_iterations"] = counters.cg_iterations;
  }
  if (simulation.scene().terrain) {
    const Extent extent = simulation.flow_extent();
    for (const auto& [name, member] : extent_columns) s[name] = extent.*member;
    const mpm::Simulation::PlanMaps plan = simulation.plan_maps();
    s["largest_depth_m"] = *std::max_element(plan.depth_max_m.begin(), plan.depth_max_m.end());
    s["largest_speed_m_per_s"] = *std::max_element(plan.speed_max.begin(), plan.speed_max.end());
  }
  if (counters.out_of_balance > 0.0) s["out_of_balance"] = counters.out_of_balance;
  s["sessions"] = record.sessions;
  s["warnings"] = facts.warnings;
  s["input"] = to_json(facts.input);
  return s.dump(2) + "\n";
}

}  // namespace repose::study
