/// Where μ(I) is ill-posed: the criterion against the growth of noise, what bounds it, and where a
/// collapse meets it.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "models/ill_posedness.hpp"
#include "mpm/output/history.hpp"
#include "mpm/study/ill_posed_points.hpp"
#include "report/stability/grains.hpp"
#include "report/stability/part.hpp"

namespace repose::report {
namespace {

using Json = nlohmann::ordered_json;
using point::ShearFlow;

/// ηk²/ρ over ck of the waves that judge the (incompressible) criterion, and K/p.
constexpr double acoustic_share = 0.05;
constexpr double stiffness = 1e5;

std::unique_ptr<Material> grains(const LawSpec& law, const std::string& form,
                                 const std::map<std::string, double>& values) {
  return make_material(grains_as(law, form, values));
}

/// What is measured and predicted for one flow, both in units of ηk²/ρ.
struct Judged {
  double C = 0.0, predicted = 0.0, measured = 0.0, angle_deg = 0.0, rate = 0.0;
  bool outside_margin() const { return std::abs(predicted) > neutral_margin; }
  bool agrees() const { return (predicted > 0.0) == (measured > 0.0); }
};

Judged judge(const Material& material, const ShearFlow& flow, double share,
             std::size_t directions) {
  const ShearResponse response = shear_response(material, flow.p, flow.shear_rate).value();
  const double k = point::wave_number_of_share(material, flow, share);
  const point::WaveGrowth wave = point::fastest(point::wave_growth(material, flow, k, directions));
  return {ill_posedness(response), growth_of_direction(response, fastest_direction(response)),
          wave.rate / point::viscous_rate(material, flow, k), wave.angle * 180.0 / std::numbers::pi,
          wave.rate};
}

class GrainMaps {
 public:
  GrainMaps(const input::StabilityInput& input, PartOutput& out)
      : input_(input),
        out_(out),
        directions_(input.quick ? 48 : 96) {}

  Json run() {
    Json j{{"margin", neutral_margin}, {"acoustic_share", acoustic_share}, {"K_over_p", stiffness}};
    j["boundary"] = boundary();
    j["refinement"] = refinement();
    j["curves"] = curves();
    j["shear_cell"] = shear_cell(input_, out_);
    j["collapse"] = collapse();
    return j;
  }

 private:
  /// The criterion against growth over (I, μ_d/μ_0) and (I, μ_0).
  Json boundary() {
    const auto numbers = decades(1e-3, 10.0, input_.quick ? 9 : 25);
    const int m = input_.quick ? 5 : 13;
    const double mu_0 = value("mu_0"), mu_d = value("mu_d");
    Figure figure("Ill-posed flow of μ(I): fastest growth of short waves in plane shear",
                  "colour: measured with the law's update, in units of ηk²/ρ; rings: C > 0, "
                  "ill-posed");
    figure.columns = 2;
    std::string csv = "map,I,mu_0,mu_d,C,predicted,measured,angle_deg,outside_margin,agrees\n";
    int points = 0, outside = 0, agree_outside = 0, agree = 0;
    for (const bool ratio : {true, false}) {
      Axes& axes = figure.add_axes();
      axes.title = ratio ? fmt::format("μ_{{0}} = {:.4g}", mu_0)
                         : fmt::format("μ_{{d}}/μ_{{0}} = {:.4g}", mu_d / mu_0);
      axes.x = {"I", AxisScale::logarithmic, 7e-4, 14.0};
      axes.y.label = ratio ? "μ_{d}/μ_{0}" : "μ_{0}";
      std::vector<double> x, y, z, ill_x, ill_y;
      for (int j = 0; j < m; ++j) {
        const double t = j / (m - 1.0);
        const double low = ratio ? mu_0 : 0.1 + 0.6 * t;
        const double high = ratio ? mu_0 * (1.05 + 1.95 * t) : low * mu_d / mu_0;
        const auto material = grains(input_.grains, "elastoviscoplastic",
                                     {{"mu_0", low}, {"mu_d", high}, {"K", stiffness * input_.p}});
        for (const double I : numbers) {
          const Judged g =
              judge(*material, flow_of(*material, input_.p, I), acoustic_share, directions_);
          ++points;
          agree += g.agrees() ? 1 : 0;
          outside += g.outside_margin() ? 1 : 0;
          agree_outside += g.outside_margin() && g.agrees() ? 1 : 0;
          csv += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", ratio ? "ratio" : "mu_0", I, low,
                             high, g.C, g.predicted, g.measured, g.angle_deg,
                             g.outside_margin() ? 1 : 0, g.agrees() ? 1 : 0);
          x.push_back(I);
          y.push_back(ratio ? high / low : low);
          z.push_back(std::clamp(g.measured, -0.1, 0.1));
          if (g.C > 0.0) {
            ill_x.push_back(x.back());
            ill_y.push_back(y.back());
          }
        }
      }
      ScatterStyle style;
      style.marker_px = 10.0;
      axes.legend = Legend::none;
      axes.scatter(x, y, z, Axis{"growth", AxisScale::linear, -0.1, 0.1}, style);
      axes.points("C > 0", ill_x, ill_y, {Colour::black, 1.0, Marker::ring, 12.0});
    }
    out_.table("mu_i_boundary.csv", csv);
    out_.picture("mu_i_boundary.svg", figure);
    const double share = static_cast<double>(agree_outside) / std::max(1, outside);
    out_.tell(fmt::format(
        "mu_i: criterion and growth agree on the sign in {} of {} points outside "
        "the margin ({:.4g} %); inside: {} of {}",
        agree_outside, outside, 100.0 * share, agree - agree_outside, points - outside));
    return Json{{"points", points},
                {"outside_margin", outside},
                {"agree_outside_margin", agree_outside},
                {"share_outside_margin", share},
                {"agree_inside_margin", agree - agree_outside}};
  }

  /// Growth against wavelength: unbounded without a compressibility, bounded and rising with K.
  Json refinement() {
    const double I = 0.01;
    const auto shares = decades(0.1, 20.0, input_.quick ? 5 : 14);
    Figure figure(fmt::format("Growth over the wavelength, I = {}, p = {:.3g} Pa", I, input_.p),
                  "the fastest direction; dashed: incompressible, gηk²/ρ");
    Axes& axes = figure.add_axes();
    axes.x = {"wavelength/d", AxisScale::logarithmic};
    axes.y = {"growth rate/γ̇", AxisScale::logarithmic};
    std::string csv = "K,wavelength_over_d,share,predicted,measured,rate_over_shear_rate\n";
    Json json = Json::array();
    std::vector<double> all_x, all_y;
    for (const double factor : {0.1, 1.0, 10.0, 100.0}) {
      const double K = factor * value("K");
      const auto material = grains(input_.grains, "elastoviscoplastic", {{"K", K}});
      const ShearFlow flow = flow_of(*material, input_.p, I);
      std::vector<double> x, y;
      double most = -HUGE_VAL, at = 0.0;
      for (const double share : shares) {
        const Judged g = judge(*material, flow, share, directions_);
        const double length = 2.0 * std::numbers::pi /
                              point::wave_number_of_share(*material, flow, share) /
                              material->parameter("d");
        csv += fmt::format("{},{},{},{},{},{}\n", K, length, share, g.predicted, g.measured,
                           g.rate / flow.shear_rate);
        x.push_back(length);
        y.push_back(g.rate / flow.shear_rate);
        all_x.push_back(length);
        all_y.push_back(g.predicted *
                        point::viscous_rate(*material, flow,
                                            point::wave_number_of_share(*material, flow, share)) /
                        flow.shear_rate);
        if (y.back() > most) {
          most = y.back();
          at = length;
        }
      }
      axes.line(fmt::format("K = {:.3g} Pa", K), x, y,
                {Colour::automatic, 1.8, Marker::circle, 5.0});
      json.push_back(
          {{"K", K}, {"most_growth_over_shear_rate", most}, {"at_wavelength_over_d", at}});
    }
    std::vector<std::size_t> order(all_x.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return all_x[a] < all_x[b]; });
    std::vector<double> line_x, line_y;
    for (const std::size_t i : order) {
      line_x.push_back(all_x[i]);
      line_y.push_back(all_y[i]);
    }
    axes.dashed("incompressible", line_x, line_y, {Colour::black, 1.2});
    out_.table("mu_i_refinement.csv", csv);
    out_.picture("mu_i_refinement.svg", figure);
    return json;
  }

  /// Growth over I for the three forms, and over r for the regularised one.
  Json curves() {
    const auto numbers = decades(1e-3, 10.0, input_.quick ? 7 : 25);
    Figure figure("Growth of short waves for the forms of μ(I)",
                  "points: measured, lines: predicted; in units of ηk²/ρ; > 0 is ill-posed");
    figure.columns = 2;
    std::string csv = "form,I,r,C,predicted,measured\n";
    Json json;
    Axes& over_I = figure.add_axes();
    over_I.title = "flow curves";
    over_I.x = {"I", AxisScale::logarithmic};
    over_I.y = {"fastest growth", AxisScale::linear, -0.4, 0.15};
    const std::vector<double> ends{numbers.front(), numbers.back()}, zero{0.0, 0.0};
    over_I.line("", ends, zero, {Colour::grey, 1.0});
    for (const auto& [form, colour] : {std::pair{"elastoviscoplastic", Colour::blue},
                                       {"regularised", Colour::orange},
                                       {"barker_gray", Colour::vermillion}}) {
      std::map<std::string, double> values{{"K", stiffness * input_.p}};
      if (std::string(form) != "elastoviscoplastic") values["r"] = 1e-4;
      std::unique_ptr<Material> material;
      try {
        material = grains(input_.grains, form, values);
      } catch (const InputError& error) {  // a curve that is nowhere well-posed has no I_1
        json[form] = {{"left_out", error.what()}};
        continue;
      }
      std::vector<double> measured, predicted;
      double most = -HUGE_VAL;
      for (const double I : numbers) {
        const Judged g =
            judge(*material, flow_of(*material, input_.p, I), acoustic_share, directions_);
        csv += fmt::format("{},{},{},{},{},{}\n", form, I,
                           values.contains("r") ? values["r"] : std::nan(""), g.C, g.predicted,
                           g.measured);
        measured.push_back(g.measured);
        predicted.push_back(g.predicted);
        most = std::max(most, g.measured);
      }
      over_I.line("", numbers, predicted, {colour, 1.2});
      over_I.points(form, numbers, measured, {colour, 1.0, Marker::circle, 5.0});
      json[form] = {{"most_growth", most}};
    }
    Axes& over_r = figure.add_axes();
    const double I = 0.01;
    over_r.title = fmt::format("regularised, I = {}", I);
    over_r.x = {"r/γ̇", AxisScale::logarithmic};
    over_r.y.label = "fastest growth";
    std::vector<double> x, measured, predicted;
    for (const double ratio : decades(1e-3, 10.0, input_.quick ? 7 : 21)) {
      auto material = grains(input_.grains, "regularised", {{"K", stiffness * input_.p}});
      const ShearFlow flow = flow_of(*material, input_.p, I);
      const double r = ratio * flow.shear_rate;
      material = grains(input_.grains, "regularised", {{"K", stiffness * input_.p}, {"r", r}});
      const Judged g = judge(*material, flow, acoustic_share, directions_);
      csv += fmt::format("regularised,{},{},{},{},{}\n", I, r, g.C, g.predicted, g.measured);
      x.push_back(ratio);
      measured.push_back(g.measured);
      predicted.push_back(g.predicted);
    }
    over_r.line("predicted", x, predicted, {Colour::orange, 1.2});
    over_r.points("measured", x, measured, {Colour::orange, 1.0, Marker::circle, 5.0});
    for (std::size_t i = 1; i < x.size(); ++i)
      if (measured[i - 1] > 0.0 && measured[i] <= 0.0)
        json["regularised"]["well_posed_from_r_over_shear_rate"] = x[i];
    out_.table("mu_i_curves.csv", csv);
    out_.picture("mu_i_curves.svg", figure);
    return json;
  }

  /// Ill-posed points of the paper's column as it collapses.
  Json collapse() {
    mpm::Scene scene = paper_scene("flat_mu_i", {input_.quick ? "grid.h=0.05" : "grid.h=0.0125"});
    raise_top_to_cells(scene);
    scene.bodies.front().law = input_.grains;
    scene.end_time = input_.quick ? 0.6 : 1.2;
    if (input_.grains.options.contains("form") &&
        input_.grains.options.at("form") != "elastoviscoplastic")
      scene.viscosity = mpm::Viscosity::implicit_solve;
    const int rows = input_.quick ? 12 : 60;
    std::vector<double> time, flowing, ill;
    std::string csv = "time_s,flowing_share,ill_posed_share\n";
    mpm::Simulation::Snapshot shown;
    std::vector<double> shown_C;
    double shown_time = 0.0, most = 0.0;
    const auto history = mpm::record(scene, {}, rows, [&](const mpm::Simulation& simulation) {
      const auto points = simulation.snapshot();
      const std::vector<double> C = mpm::ill_posedness(scene, points);
      const auto share = mpm::ill_posed_share(points, C);
      time.push_back(simulation.time());
      flowing.push_back(100.0 * share.flowing);
      ill.push_back(100.0 * share.ill_posed);
      csv += fmt::format("{},{},{}\n", time.back(), share.flowing, share.ill_posed);
      most = std::max(most, share.ill_posed);
      if (shown_time == 0.0 && simulation.time() > 0.28) {
        shown = points;
        shown_C = C;
        shown_time = simulation.time();
      }
    });
    out_.table("mu_i_collapse.csv", csv);
    Figure figure("Ill-posed points of the flat column",
                  fmt::format("{} points, h = {} m", shown.x_m.size(), scene.h));
    figure.columns = 1;
    figure.panel_width_px = 620.0;
    figure.panel_height_px = 220.0;
    Axes& shares = figure.add_axes();
    shares.x.label = "time (s)";
    shares.y.label = "share of mass (%)";
    shares.line("flows", time, flowing, {Colour::blue});
    shares.line("C > 0, ill-posed", time, ill, {Colour::vermillion});
    if (!shown.x_m.empty()) {
      Axes& picture = figure.add_axes();
      picture.title = fmt::format("{:.2f} s; crosses: no flow", shown_time);
      picture.x.label = "x (m)";
      picture.y.label = "y (m)";
      picture.equal_aspect = true;
      for (double& C : shown_C) C = std::clamp(C, -0.2, 0.2);
      ScatterStyle style;
      style.diameter = 0.9 * mpm::point_spacing(scene);
      picture.scatter(shown.x_m, shown.y_m, shown_C, Axis{"C", AxisScale::linear, -0.2, 0.2},
                      style);
    }
    out_.picture("mu_i_collapse.svg", figure);
    Json json{{"h_m", scene.h}, {"most_ill_posed_share", most}};
    if (!history.failure.empty()) json["failure"] = history.failure;
    double of_flow = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < time.size(); ++i) {
      of_flow += ill[i];
      sum += flowing[i];
    }
    json["ill_posed_share_of_flowing_mass"] = sum > 0.0 ? of_flow / sum : 0.0;
    return json;
  }

  double value(std::string_view name) const { return input_.grains.values.at(std::string(name)); }

  const input::StabilityInput& input_;
  PartOutput& out_;
  std::size_t directions_;
};

}  // namespace

Json map_mu_i(const input::StabilityInput& input, PartOutput& out) {
  return GrainMaps(input, out).run();
}

}  // namespace repose::report
