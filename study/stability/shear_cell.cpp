#include "study/stability/shear_cell.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "models/ill_posedness.hpp"
#include "mpm/study/shear_cell.hpp"
#include "study/stability/grains.hpp"

namespace repose::study {
namespace {

using Json = io::Json;

/// Of waves that are tied to the cells.
constexpr int cells_per_wave = 8;
/// In units of ρ/(ηk²): the relaxation time, which loses 0.0004 at eight cells to a wave, and how
/// long a long wave and noise are followed.
constexpr double relaxation = 40.0, duration = 50.0, duration_of_noise = 150.0;
constexpr std::size_t samples = 50;

struct SteadyShear {
  LawSpec law;
  std::unique_ptr<Material> material;
  point::ShearFlow flow;
  ShearResponse response;

  SteadyShear(const LawSpec& given, double p, double I)
      : law(given),
        material(make_material(law)),
        flow(flow_of(*material, p, I)),
        response(shear_response(*material, p, flow.shear_rate).value()) {}

  double fastest() const { return growth_of_direction(response, fastest_direction(response)); }
  double wavelength_of(double share) const {
    return 2.0 * std::numbers::pi / point::wave_number_of_share(*material, flow, share);
  }
  double viscous_rate(double wavelength) const {
    return point::viscous_rate(*material, flow, 2.0 * std::numbers::pi / wavelength);
  }
};

mpm::ShearCell cell_of(const SteadyShear& shear, double wavelength, int cells) {
  mpm::ShearCell cell;
  cell.law = shear.law;
  cell.p = shear.flow.p;
  cell.shear_rate = shear.flow.shear_rate;
  cell.wavelength = wavelength;
  cell.cells = cells;
  // β = sin 2θ: tan θ = (1 + √(1 − β²))/β of the two fastest directions, the one that hardly turns
  const double beta = fastest_direction(shear.response);
  cell.slope =
      std::clamp(static_cast<int>(std::lround((1.0 + std::sqrt(1.0 - beta * beta)) / beta)), 4, 12);
  cell.relaxation_time = relaxation / shear.viscous_rate(wavelength);
  return cell;
}

/// Rates in units of ηk²/ρ.
struct Rates {
  double theory;    ///< of the law, at the same K, while the wave turns
  double expected;  ///< the same of the wave as the method sees it, less what transfers lose
  double measured;
};

Rates measure(const SteadyShear& shear, const mpm::ShearCell& cell) {
  const double viscous = shear.viscous_rate(cell.wavelength);
  // a short wave falls by about 1 + share², and as slowly, until its pressure is there
  const double share = shear.wavelength_of(1.0) / cell.wavelength, start = 1.0 + share * share;
  const double end = std::min(duration * start / viscous, 1.5 / cell.shear_rate);
  const mpm::Growth growth = mpm::follow_growth(cell, end, 2.0 + std::log(start), samples);
  const auto rate = [&](auto&& wave_vector) {
    const auto log_size =
        point::follow_wave(*shear.material, shear.flow, wave_vector,
                           end / static_cast<double>(samples), growth.time.size());
    return mpm::late_rate(growth.time, log_size) / viscous;
  };
  const auto seen = [&](double t) {
    return mpm::seen_wave(cell.kernel, cell.wavelength / cell.cells, mpm::wave_vector(cell, t));
  };
  return {rate([&](double t) { return mpm::wave_vector(cell, t); }),
          rate([&](double t) { return seen(t).k; }) -
              seen(0.5 * growth.time.back()).loss / (cell.relaxation_time * viscous),
          mpm::late_rate(growth.time, growth.log_size) / viscous};
}

class MapOfShearCell {
 public:
  explicit MapOfShearCell(const input::StabilityInput& input) : input_(input) {}

  ShearCellMaps run() {
    maps_.p = input_.p;
    maps_.figures =
        Json{{"K_over_p", shear_cell_stiffness}, {"acoustic_share", shear_cell_acoustic_share}};
    maps_.figures["signs"] = signs();
    maps_.figures["refinement"] = refinement();
    return std::move(maps_);
  }

 private:
  SteadyShear shear(const std::string& form, double I, double K_over_p = shear_cell_stiffness,
                    double friction_ratio = 0.0) const {
    std::map<std::string, double> values{{"K", K_over_p * input_.p}};
    if (friction_ratio > 0.0) values["mu_d"] = friction_ratio * input_.grains.values.at("mu_0");
    return {grains_as(input_.grains, form, values), input_.p, I};
  }

  /// Growth over I of the two curves, and its sign over (I, μ_d/μ_0).
  Json signs() {
    double worst = 0.0;
    std::string csv = "form,I,mu_d_over_mu_0,C,incompressible,theory,expected,measured,agrees\n";
    const auto take = [&](const std::string& form, const SteadyShear& at, double I) {
      const double C = ill_posedness(at.response);
      const Rates r =
          measure(at, cell_of(at, at.wavelength_of(shear_cell_acoustic_share), cells_per_wave));
      const bool agrees = (C > 0.0) == (r.measured > 0.0);
      const bool counts = std::abs(at.fastest()) > neutral_margin;
      ++maps_.points;
      maps_.outside += counts ? 1 : 0;
      (counts ? maps_.agree_outside : maps_.agree_inside) += agrees ? 1 : 0;
      worst = std::max(worst, std::abs(r.measured - r.expected));
      csv += fmt::format("{},{},{},{},{},{},{},{},{}\n", form, I,
                         at.material->parameter("mu_d") / at.material->parameter("mu_0"), C,
                         at.fastest(), r.theory, r.expected, r.measured, agrees ? 1 : 0);
      return r;
    };
    maps_.numbers = decades(1e-3, 10.0, input_.quick ? 4 : 13);
    Json json;
    for (const char* const form : {"elastoviscoplastic", "barker_gray"}) {
      CellCurve curve{form, maps_.numbers, {}, {}};
      try {
        for (const double I : maps_.numbers) {
          const Rates r = take(form, shear(form, I), I);
          curve.theory.push_back(r.theory);
          curve.measured.push_back(r.measured);
        }
      } catch (const InputError& error) {  // a curve that is nowhere well-posed has no I_1
        json[form] = {{"left_out", error.what()}};
        continue;
      }
      json[form] = {
          {"most_growth", *std::max_element(curve.measured.begin(), curve.measured.end())}};
      maps_.curves.push_back(std::move(curve));
    }
    if (!input_.quick) {
      CellMap& map = maps_.map.emplace();
      for (const double ratio : {1.05, 1.3, 1.6, 2.0, 2.5, 3.0})
        for (const double I : decades(1e-3, 10.0, 9)) {
          const SteadyShear at = shear("elastoviscoplastic", I, shear_cell_stiffness, ratio);
          map.I.push_back(I);
          map.ratio.push_back(ratio);
          map.measured.push_back(take("elastoviscoplastic", at, I).measured);
          map.C.push_back(ill_posedness(at.response));
        }
    }
    maps_.tables.push_back({"mu_i_shear_signs", csv});
    json["points"] = maps_.points;
    json["outside_margin"] = maps_.outside;
    json["agree_outside_margin"] = maps_.agree_outside;
    json["agree_inside_margin"] = maps_.agree_inside;
    json["largest_difference_from_expected"] = worst;
    return json;
  }

  Json refinement() {
    csv_ =
        "series,form,I,K_over_p,cells,h_over_d,wavelength_over_d,theory,expected,measured,"
        "measured_over_shear_rate\n";
    Json json;
    json["fixed_wavelength"] = fixed_wavelength();
    json["fixed_cells"] = fixed_cells();
    json["noise"] = noise();
    maps_.tables.push_back({"mu_i_shear_refinement", csv_});
    return json;
  }

  /// A row of the table; returns the rate over γ̇.
  double row(const char* series, const std::string& form, double I, double K_over_p,
             const SteadyShear& at, const mpm::ShearCell& cell, const Rates& r) {
    const double d = at.material->parameter("d");
    const double over_shear = r.measured * at.viscous_rate(cell.wavelength) / at.flow.shear_rate;
    csv_ += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", series, form, I, K_over_p, cell.cells,
                        cell.wavelength / cell.cells / d, cell.wavelength / d, r.theory, r.expected,
                        r.measured, over_shear);
    return over_shear;
  }

  /// The same wave with more cells tends to the theory.
  Json fixed_wavelength() {
    Json json = Json::array();
    for (const double I : {0.01, 0.1}) {
      const SteadyShear at = shear("elastoviscoplastic", I);
      CellConvergence series{I, {}, {}, {}};
      for (const int cells : input_.quick ? std::vector{6, 8} : std::vector{6, 8, 12, 16}) {
        const mpm::ShearCell cell = cell_of(at, at.wavelength_of(shear_cell_acoustic_share), cells);
        const Rates r = measure(at, cell);
        row("fixed_wavelength", "elastoviscoplastic", I, shear_cell_stiffness, at, cell, r);
        series.cells.push_back(cells);
        series.expected.push_back(r.expected / r.theory);
        series.measured.push_back(r.measured / r.theory);
        json.push_back({{"I", I},
                        {"cells", cells},
                        {"measured_over_theory", series.measured.back()},
                        {"expected_over_theory", series.expected.back()}});
      }
      maps_.convergence.push_back(std::move(series));
    }
    return json;
  }

  /// Waves of eight cells: the finer the cells, the faster they grow, or decay.
  Json fixed_cells() {
    struct Case {
      bool growing;
      const char* form;
      double I, K_over_p;
      const char* name;
    };
    std::vector<Case> cases{{true, "elastoviscoplastic", 0.01, 2500.0, "K = 2500 p"},
                            {false, "elastoviscoplastic", 0.1, 2500.0, "μ(I), I = 0.1"}};
    if (!input_.quick) {
      cases.push_back({true, "elastoviscoplastic", 0.01, 250.0, "K = 250 p"});
      cases.push_back({false, "barker_gray", 0.1, 2500.0, "barker_gray, I = 0.1"});
      cases.push_back({false, "barker_gray", 0.01, 2500.0, "barker_gray, I = 0.01"});
    }
    Json json = Json::array();
    for (const Case& c : cases) try {
        const SteadyShear at = shear(c.form, c.I, c.K_over_p);
        const double longest = shear("elastoviscoplastic", c.I).wavelength_of(0.1);
        CellRefinement series{c.growing, c.name, {}, {}, {}};
        for (const double part :
             input_.quick ? std::vector{0.5, 0.25} : std::vector{1.0, 0.5, 0.25, 0.125, 0.0625}) {
          const mpm::ShearCell cell = cell_of(at, longest * part, cells_per_wave);
          const Rates r = measure(at, cell);
          const double rate = row("fixed_cells", c.form, c.I, c.K_over_p, at, cell, r);
          const double sign = c.growing ? 1.0 : -1.0;
          series.h_over_d.push_back(cell.wavelength / cell.cells / at.material->parameter("d"));
          series.measured.push_back(sign * rate);
          series.theory.push_back(sign * rate * r.theory / r.measured);
          json.push_back({{"form", c.form},
                          {"I", c.I},
                          {"K_over_p", c.K_over_p},
                          {"h_over_d", series.h_over_d.back()},
                          {"rate_over_shear_rate", rate}});
        }
        maps_.refinement.push_back(std::move(series));
      } catch (const InputError& error) {
        json.push_back({{"form", c.form}, {"left_out", error.what()}});
      }
    return json;
  }

  /// Noise on every point: where the flow is ill-posed it finds the fastest wave by itself.
  Json noise() {
    Json json = Json::array();
    for (const double I : {0.01, 0.1}) {
      const SteadyShear at = shear("elastoviscoplastic", I);
      const double longest = at.wavelength_of(0.2);
      for (const double part : input_.quick ? std::vector{0.5} : std::vector{1.0, 0.5, 0.25}) {
        mpm::ShearCell cell = cell_of(at, part * longest, cells_per_wave);
        cell.noise = true;
        cell.relaxation_time *= 0.1;  // what no grid velocity can be is to go
        const double viscous = at.viscous_rate(cell.wavelength);
        const mpm::Growth growth =
            mpm::follow_growth(cell, duration_of_noise / viscous, HUGE_VAL, samples);
        const double rate = mpm::late_rate(growth.time, growth.log_size);
        row("noise", "elastoviscoplastic", I, shear_cell_stiffness, at, cell,
            {std::nan(""), std::nan(""), rate / viscous});
        std::vector<double> time = growth.time;
        for (double& t : time) t *= at.viscous_rate(longest);
        maps_.noise.push_back({I, part == 1.0, std::move(time), growth.log_size});
        json.push_back({{"I", I},
                        {"h_over_d", cell.wavelength / cell.cells / at.material->parameter("d")},
                        {"rate_over_shear_rate", rate / at.flow.shear_rate}});
      }
    }
    return json;
  }

  const input::StabilityInput& input_;
  ShearCellMaps maps_;
  std::string csv_;
};

}  // namespace

ShearCellMaps map_shear_cell(const input::StabilityInput& input) {
  return MapOfShearCell(input).run();
}

}  // namespace repose::study
