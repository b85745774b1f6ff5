#include "study/stability/collapse.hpp"

#include <cmath>

#include <fmt/core.h>

#include "models/law_material.hpp"
#include "models/linearised_cam_clay.hpp"

namespace repose::study {
namespace {

using Json = io::Json;

constexpr int rows_of_series = 60;

void add(std::string& csv, const std::string& name, const mpm::History& history) {
  for (const mpm::SeriesRow& r : history.rows)
    csv += fmt::format("{},{},{},{},{},{}\n", name, r.time_s, r.step, r.kinetic_J_per_m,
                       r.points_separated, r.front_m);
}

class Collapses {
 public:
  Collapses(const input::StabilityInput& input, const CollapseObserver& observer)
      : input_(input),
        observer_(observer),
        h_(input.quick ? "grid.h=0.05" : "grid.h=0.0125") {}

  CollapseMaps run() {
    maps_.figures["lost_points"] = lost_points();
    maps_.figures["creep"] = creep();
    maps_.tables.push_back({"collapse", csv_});
    return std::move(maps_);
  }

 private:
  /// The linearised update in Cam-Clay loses points; the exact one, from the same step, none.
  Json lost_points() {
    struct Case {
      std::string key;
      double dt, tilt;  ///< dt at h = 12.5 mm, longer in proportion on coarser cells
    };
    Json json = Json::array();
    for (const Case& c : {Case{"flat", 6e-5, 0.0}, Case{"tilted", 3e-5, 35.0}}) {
      if (input_.quick && c.tilt > 0.0) continue;
      const double dt = input_.quick ? 4.0 * c.dt : c.dt;
      mpm::Scene scene =
          paper_scene("flat_mcc", {h_, fmt::format("scene.tilt_deg={:.1f}", c.tilt),
                                   fmt::format("step.dt={}", dt), "step.transfer=apic",
                                   fmt::format("grid.points_per_cell={}", input_.quick ? 4 : 16)});
      raise_top_to_cells(scene);
      scene.end_time = input_.quick ? 0.4 : c.tilt > 0.0 ? 0.9 : 1.2;
      maps_.h = scene.h;
      for (const bool linearised : {true, false}) {
        mpm::Prescribed prescribed;
        if (linearised)
          prescribed.material = std::make_shared<LawMaterial<LinearisedCamClay>>(
              checked_parameters(scene.bodies.front().law));
        ClayCollapse run{c.key, c.tilt, dt, linearised,
                         mpm::record(scene, prescribed, rows_of_series)};
        const mpm::History& history = run.history;
        const std::string name = linearised ? "linearised" : "exact";
        add(csv_, fmt::format("clay_{}_{}", c.key, name), history);
        json.push_back({{"case", c.key},
                        {"update", name},
                        {"dt_s", dt},
                        {"points_without_stress_at_end", history.rows.back().points_separated},
                        {"ended_at_s", history.rows.back().time_s},
                        {"failure", history.failure}});
        if (observer_.clay) observer_.clay(run);
        maps_.clay.push_back(std::move(run));
      }
    }
    return json;
  }

  /// Kinetic energy: the regularised viscosity beyond its explicit limit never rests.
  Json creep() {
    struct Case {
      std::string key, title;
      std::vector<std::string> sets;
    };
    const std::vector<Case> cases{
        {"regularised_explicit",
         "regularised, explicit, Δt = 3e-5 s",
         {"body[0].law.form=regularised", "step.dt=3e-5", "step.transfer=apic"}},
        {"regularised_implicit",
         "regularised, implicit viscosity",
         {"body[0].law.form=regularised", "step.viscosity=implicit"}},
        {"elastoviscoplastic", "elasto-viscoplastic", {}}};
    Json json = Json::array();
    for (const Case& c : cases) {
      std::vector<std::string> sets = c.sets;
      sets.push_back(h_);
      mpm::Scene scene = paper_scene("flat_mu_i", sets);
      raise_top_to_cells(scene);
      GrainCollapse run{c.key, c.title, mpm::record(scene, {}, rows_of_series)};
      const mpm::History& history = run.history;
      add(csv_, c.key, history);
      const mpm::SeriesRow& last = history.rows.back();
      json.push_back({{"case", c.key},
                      {"kinetic_J_per_m_at_end", last.kinetic_J_per_m},
                      {"front_m", last.front_m},
                      {"steps", last.step},
                      {"failure", history.failure}});
      if (observer_.grains) observer_.grains(run);
      maps_.grains.push_back(std::move(run));
    }
    return json;
  }

  const input::StabilityInput& input_;
  const CollapseObserver& observer_;
  std::string h_;
  CollapseMaps maps_;
  std::string csv_ = "run,time_s,step,kinetic_J_per_m,points_without_stress,front_m\n";
};

}  // namespace

CollapseMaps map_collapse(const input::StabilityInput& input, const CollapseObserver& observer) {
  return Collapses(input, observer).run();
}

std::string words_of(const ClayCollapse& run) {
  const mpm::SeriesRow& last = run.history.rows.back();
  return fmt::format("collapse: Cam-Clay {}, {} update: {} points without stress at {:.2f} s{}",
                     run.key, run.linearised ? "linearised" : "exact", last.points_separated,
                     last.time_s, run.history.failure.empty() ? "" : ", then failed");
}

std::string words_of(const GrainCollapse& run) {
  const mpm::SeriesRow& last = run.history.rows.back();
  return fmt::format("collapse: mu(I), {}: {:.2g} J/m at {:.2f} s after {} steps", run.key,
                     last.kinetic_J_per_m, last.time_s, last.step);
}

}  // namespace repose::study
