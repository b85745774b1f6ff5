#include "study/stability/mu_i.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "models/ill_posedness.hpp"
#include "mpm/output/history.hpp"
#include "mpm/study/ill_posed_points.hpp"
#include "study/stability/grains.hpp"

namespace repose::study {
namespace {

using Json = io::Json;
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

class MapOfGrains {
 public:
  explicit MapOfGrains(const input::StabilityInput& input)
      : input_(input),
        directions_(input.quick ? 48 : 96) {}

  GrainMaps run() {
    maps_.p = input_.p;
    Json& j = maps_.figures;
    j = Json{
        {"margin", neutral_margin}, {"acoustic_share", acoustic_share}, {"K_over_p", stiffness}};
    j["boundary"] = boundary();
    j["refinement"] = refinement();
    j["curves"] = curves();
    maps_.shear_cell = map_shear_cell(input_);
    j["shear_cell"] = maps_.shear_cell.figures;
    maps_.tables.insert(maps_.tables.end(), maps_.shear_cell.tables.begin(),
                        maps_.shear_cell.tables.end());
    j["collapse"] = collapse();
    return std::move(maps_);
  }

 private:
  /// The criterion against growth over (I, μ_d/μ_0) and (I, μ_0).
  Json boundary() {
    const auto numbers = decades(1e-3, 10.0, input_.quick ? 9 : 25);
    const int m = input_.quick ? 5 : 13;
    const double mu_0 = value("mu_0"), mu_d = value("mu_d");
    std::string csv = "map,I,mu_0,mu_d,C,predicted,measured,angle_deg,outside_margin,agrees\n";
    for (const bool ratio : {true, false}) {
      GrowthMap map{ratio, mu_0, mu_d, {}, {}, {}, {}};
      for (int j = 0; j < m; ++j) {
        const double t = j / (m - 1.0);
        const double low = ratio ? mu_0 : 0.1 + 0.6 * t;
        const double high = ratio ? mu_0 * (1.05 + 1.95 * t) : low * mu_d / mu_0;
        const auto material = grains(input_.grains, "elastoviscoplastic",
                                     {{"mu_0", low}, {"mu_d", high}, {"K", stiffness * input_.p}});
        for (const double I : numbers) {
          const Judged g =
              judge(*material, flow_of(*material, input_.p, I), acoustic_share, directions_);
          ++maps_.points;
          maps_.outside += g.outside_margin() ? 1 : 0;
          (g.outside_margin() ? maps_.agree_outside : maps_.agree_inside) += g.agrees() ? 1 : 0;
          csv += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", ratio ? "ratio" : "mu_0", I, low,
                             high, g.C, g.predicted, g.measured, g.angle_deg,
                             g.outside_margin() ? 1 : 0, g.agrees() ? 1 : 0);
          map.I.push_back(I);
          map.second.push_back(ratio ? high / low : low);
          map.C.push_back(g.C);
          map.measured.push_back(g.measured);
        }
      }
      maps_.boundary.push_back(std::move(map));
    }
    maps_.tables.push_back({"mu_i_boundary", csv});
    const double share = static_cast<double>(maps_.agree_outside) / std::max(1, maps_.outside);
    return Json{{"points", maps_.points},
                {"outside_margin", maps_.outside},
                {"agree_outside_margin", maps_.agree_outside},
                {"share_outside_margin", share},
                {"agree_inside_margin", maps_.agree_inside}};
  }

  /// Growth against wavelength: unbounded without a compressibility, bounded and rising with K.
  Json refinement() {
    const double I = maps_.spectrum_I = 0.01;
    const auto shares = decades(0.1, 20.0, input_.quick ? 5 : 14);
    std::string csv = "K,wavelength_over_d,share,predicted,measured,rate_over_shear_rate\n";
    Json json = Json::array();
    std::vector<double> all_x, all_y;
    for (const double factor : {0.1, 1.0, 10.0, 100.0}) {
      const double K = factor * value("K");
      const auto material = grains(input_.grains, "elastoviscoplastic", {{"K", K}});
      const ShearFlow flow = flow_of(*material, input_.p, I);
      GrowthSpectrum spectrum{K, {}, {}};
      double most = -HUGE_VAL, at = 0.0;
      for (const double share : shares) {
        const Judged g = judge(*material, flow, share, directions_);
        const double length = 2.0 * std::numbers::pi /
                              point::wave_number_of_share(*material, flow, share) /
                              material->parameter("d");
        csv += fmt::format("{},{},{},{},{},{}\n", K, length, share, g.predicted, g.measured,
                           g.rate / flow.shear_rate);
        spectrum.wavelength_over_d.push_back(length);
        spectrum.rate_over_shear_rate.push_back(g.rate / flow.shear_rate);
        all_x.push_back(length);
        all_y.push_back(g.predicted *
                        point::viscous_rate(*material, flow,
                                            point::wave_number_of_share(*material, flow, share)) /
                        flow.shear_rate);
        if (spectrum.rate_over_shear_rate.back() > most) {
          most = spectrum.rate_over_shear_rate.back();
          at = length;
        }
      }
      maps_.spectra.push_back(std::move(spectrum));
      json.push_back(
          {{"K", K}, {"most_growth_over_shear_rate", most}, {"at_wavelength_over_d", at}});
    }
    std::vector<std::size_t> order(all_x.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return all_x[a] < all_x[b]; });
    for (const std::size_t i : order) {
      maps_.incompressible.wavelength_over_d.push_back(all_x[i]);
      maps_.incompressible.rate_over_shear_rate.push_back(all_y[i]);
    }
    maps_.tables.push_back({"mu_i_refinement", csv});
    return json;
  }

  /// Growth over I for the three forms, and over r for the regularised one.
  Json curves() {
    maps_.numbers = decades(1e-3, 10.0, input_.quick ? 7 : 25);
    std::string csv = "form,I,r,C,predicted,measured\n";
    Json json;
    for (const char* const form : {"elastoviscoplastic", "regularised", "barker_gray"}) {
      std::map<std::string, double> values{{"K", stiffness * input_.p}};
      if (std::string(form) != "elastoviscoplastic") values["r"] = 1e-4;
      std::unique_ptr<Material> material;
      try {
        material = grains(input_.grains, form, values);
      } catch (const InputError& error) {  // a curve that is nowhere well-posed has no I_1
        json[form] = {{"left_out", error.what()}};
        continue;
      }
      GrowthCurve curve{form, maps_.numbers, {}, {}};
      double most = -HUGE_VAL;
      for (const double I : maps_.numbers) {
        const Judged g =
            judge(*material, flow_of(*material, input_.p, I), acoustic_share, directions_);
        csv += fmt::format("{},{},{},{},{},{}\n", form, I,
                           values.contains("r") ? values["r"] : std::nan(""), g.C, g.predicted,
                           g.measured);
        curve.measured.push_back(g.measured);
        curve.predicted.push_back(g.predicted);
        most = std::max(most, g.measured);
      }
      maps_.curves.push_back(std::move(curve));
      json[form] = {{"most_growth", most}};
    }
    GrowthOverR& over_r = maps_.over_r;
    const double I = over_r.I = 0.01;
    for (const double ratio : decades(1e-3, 10.0, input_.quick ? 7 : 21)) {
      auto material = grains(input_.grains, "regularised", {{"K", stiffness * input_.p}});
      const ShearFlow flow = flow_of(*material, input_.p, I);
      const double r = ratio * flow.shear_rate;
      material = grains(input_.grains, "regularised", {{"K", stiffness * input_.p}, {"r", r}});
      const Judged g = judge(*material, flow, acoustic_share, directions_);
      csv += fmt::format("regularised,{},{},{},{},{}\n", I, r, g.C, g.predicted, g.measured);
      over_r.ratio.push_back(ratio);
      over_r.measured.push_back(g.measured);
      over_r.predicted.push_back(g.predicted);
    }
    for (std::size_t i = 1; i < over_r.ratio.size(); ++i)
      if (over_r.measured[i - 1] > 0.0 && over_r.measured[i] <= 0.0)
        json["regularised"]["well_posed_from_r_over_shear_rate"] = over_r.ratio[i];
    maps_.tables.push_back({"mu_i_curves", csv});
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
    IllPosedCollapse& shown = maps_.collapse;
    shown.h = scene.h;
    shown.point_spacing = mpm::point_spacing(scene);
    std::string csv = "time_s,flowing_share,ill_posed_share\n";
    double most = 0.0;
    const auto history = mpm::record(scene, {}, rows, [&](const mpm::Simulation& simulation) {
      const auto points = simulation.snapshot();
      const std::vector<double> C = mpm::ill_posedness(scene, points);
      const auto share = mpm::ill_posed_share(points, C);
      shown.time.push_back(simulation.time());
      shown.flowing_percent.push_back(100.0 * share.flowing);
      shown.ill_percent.push_back(100.0 * share.ill_posed);
      csv += fmt::format("{},{},{}\n", simulation.time(), share.flowing, share.ill_posed);
      most = std::max(most, share.ill_posed);
      if (shown.shown_time == 0.0 && simulation.time() > 0.28) {
        shown.x_m = points.x_m;
        shown.y_m = points.y_m;
        shown.C = C;
        shown.shown_time = simulation.time();
      }
    });
    maps_.tables.push_back({"mu_i_collapse", csv});
    Json json{{"h_m", scene.h}, {"most_ill_posed_share", most}};
    if (!history.failure.empty()) json["failure"] = history.failure;
    double of_flow = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < shown.time.size(); ++i) {
      of_flow += shown.ill_percent[i];
      sum += shown.flowing_percent[i];
    }
    json["ill_posed_share_of_flowing_mass"] = sum > 0.0 ? of_flow / sum : 0.0;
    return json;
  }

  double value(std::string_view name) const { return input_.grains.values.at(std::string(name)); }

  const input::StabilityInput& input_;
  GrainMaps maps_;
  std::size_t directions_;
};

}  // namespace

GrainMaps map_mu_i(const input::StabilityInput& input) { return MapOfGrains(input).run(); }

std::string words_of(const GrainMaps& maps) {
  const ShearCellMaps& cell = maps.shear_cell;
  return fmt::format(
      "mu_i: criterion and growth agree on the sign in {} of {} points outside the margin "
      "({:.4g} %); inside: {} of {}\n"
      "mu_i: criterion and growth in a Material Point shear cell agree on the sign in {} of {} "
      "points outside the margin; inside: {} of {}",
      maps.agree_outside, maps.outside,
      100.0 * maps.figures["boundary"]["share_outside_margin"].get<double>(), maps.agree_inside,
      maps.points - maps.outside, cell.agree_outside, cell.outside, cell.agree_inside,
      cell.points - cell.outside);
}

}  // namespace repose::study
