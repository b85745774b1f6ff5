/// The failures that published runs show, on purpose, beside the runs that mend them.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "models/law_material.hpp"
#include "models/linearised_cam_clay.hpp"
#include "mpm/output/history.hpp"
#include "report/stability/part.hpp"

namespace repose::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr int rows = 60;

void add(std::string& csv, const std::string& name, const mpm::History& history) {
  for (const mpm::SeriesRow& r : history.rows)
    csv += fmt::format("{},{},{},{},{},{}\n", name, r.time_s, r.step, r.kinetic_J_per_m,
                       r.points_separated, r.front_m);
}

class Collapses {
 public:
  Collapses(const input::StabilityInput& input, PartOutput& out)
      : input_(input),
        out_(out),
        h_(input.quick ? "grid.h=0.05" : "grid.h=0.0125") {}

  Json run() {
    Figure figure("Failures of published runs, and mended",
                  fmt::format("the paper's column, {} m cells", h_.substr(7)));
    figure.columns = 2;
    Json json{{"lost_points", lost_points(figure)}, {"creep", creep(figure)}};
    out_.table("collapse.csv", csv_);
    out_.picture("collapse.svg", figure);
    return json;
  }

 private:
  /// The linearised update in Cam-Clay loses points; the exact one, from the same step, none.
  Json lost_points(Figure& figure) {
    struct Case {
      std::string key;
      double dt, tilt;  ///< dt at h = 12.5 mm, longer in proportion on coarser cells
    };
    Json json = Json::array();
    for (const Case& c : {Case{"flat", 6e-5, 0.0}, Case{"tilted", 3e-5, 35.0}}) {
      if (input_.quick && c.tilt > 0.0) continue;
      const double dt = input_.quick ? 4.0 * c.dt : c.dt;
      mpm::Scene scene = paper_scene(
          "flat_mcc", {h_, fmt::format("scene.tilt_deg={:.1f}", c.tilt),
                       fmt::format("step.dt={}", dt), "step.transfer=apic", "step.sleep_speed=0",
                       fmt::format("grid.points_per_cell={}", input_.quick ? 4 : 16)});
      raise_top_to_cells(scene);
      scene.end_time = input_.quick ? 0.4 : c.tilt > 0.0 ? 0.9 : 1.2;
      Axes& axes = figure.add_axes();
      axes.title = fmt::format("Cam-Clay, {}°, Δt = {} s", c.tilt, dt);
      axes.x.label = "time (s)";
      axes.y = {"points without stress", AxisScale::linear, 0.0, {}};
      for (const bool linearised : {true, false}) {
        mpm::Prescribed prescribed;
        if (linearised)
          prescribed.material = std::make_shared<LawMaterial<LinearisedCamClay>>(
              checked_parameters(scene.bodies.front().law));
        const mpm::History history = mpm::record(scene, prescribed, rows);
        const std::string name = linearised ? "linearised" : "exact";
        add(csv_, fmt::format("clay_{}_{}", c.key, name), history);
        std::vector<double> t, y;
        for (const mpm::SeriesRow& r : history.rows) {
          t.push_back(r.time_s);
          y.push_back(static_cast<double>(r.points_separated));
        }
        axes.line(linearised ? "linearised: lost for good" : "exact: apart, and back again", t, y);
        json.push_back({{"case", c.key},
                        {"update", name},
                        {"dt_s", dt},
                        {"points_without_stress_at_end", history.rows.back().points_separated},
                        {"ended_at_s", history.rows.back().time_s},
                        {"failure", history.failure}});
        out_.tell(fmt::format(
            "collapse: Cam-Clay {}, {} update: {} points without stress at {:.2f} "
            "s{}",
            c.key, name, history.rows.back().points_separated, history.rows.back().time_s,
            history.failure.empty() ? "" : ", then failed"));
      }
    }
    return json;
  }

  /// Kinetic energy: the regularised viscosity beyond its explicit limit never rests.
  Json creep(Figure& figure) {
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
    Axes& axes = figure.add_axes();
    axes.title = "μ(I): does it come to rest?";
    axes.x.label = "time (s)";
    axes.y = {"kinetic energy (J/m)", AxisScale::logarithmic, 1e-7, 1e2};
    Json json = Json::array();
    for (const Case& c : cases) {
      std::vector<std::string> sets = c.sets;
      sets.push_back(h_);
      mpm::Scene scene = paper_scene("flat_mu_i", sets);
      raise_top_to_cells(scene);
      const mpm::History history = mpm::record(scene, {}, rows);
      add(csv_, c.key, history);
      std::vector<double> t, y;
      for (const mpm::SeriesRow& r : history.rows) {
        t.push_back(r.time_s);
        y.push_back(r.kinetic_J_per_m);
      }
      axes.line(c.title, t, y);
      const mpm::SeriesRow& last = history.rows.back();
      json.push_back({{"case", c.key},
                      {"kinetic_J_per_m_at_end", last.kinetic_J_per_m},
                      {"front_m", last.front_m},
                      {"steps", last.step},
                      {"failure", history.failure}});
      out_.tell(fmt::format("collapse: mu(I), {}: {:.2g} J/m at {:.2f} s after {} steps", c.key,
                            last.kinetic_J_per_m, last.time_s, last.step));
    }
    return json;
  }

  const input::StabilityInput& input_;
  PartOutput& out_;
  std::string h_;
  std::string csv_ = "run,time_s,step,kinetic_J_per_m,points_without_stress,front_m\n";
};

}  // namespace

Json map_collapse(const input::StabilityInput& input, PartOutput& out) {
  return Collapses(input, out).run();
}

}  // namespace repose::report
