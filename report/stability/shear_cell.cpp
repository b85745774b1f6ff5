/// Growth in plane shear measured with the Material Point Method: its sign against the criterion,
/// and its size under refinement.
#include "mpm/study/shear_cell.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "models/ill_posedness.hpp"
#include "report/stability/grains.hpp"
#include "report/stability/part.hpp"

namespace repose::report {
namespace {

using Json = nlohmann::ordered_json;

/// K/p and ηk²/ρ over ck of the waves that judge the criterion: ηk²/ρ is a thousand γ̇, and the
/// pressure follows to 0.16.
constexpr double stiffness = 2500.0;
constexpr double acoustic_share = 0.4;
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

class ShearCellMaps {
 public:
  ShearCellMaps(const input::StabilityInput& input, PartOutput& out) : input_(input), out_(out) {}

  Json run() {
    Json j{{"K_over_p", stiffness}, {"acoustic_share", acoustic_share}};
    j["signs"] = signs();
    j["refinement"] = refinement();
    return j;
  }

 private:
  SteadyShear shear(const std::string& form, double I, double K_over_p = stiffness,
                    double friction_ratio = 0.0) const {
    std::map<std::string, double> values{{"K", K_over_p * input_.p}};
    if (friction_ratio > 0.0) values["mu_d"] = friction_ratio * input_.grains.values.at("mu_0");
    return {grains_as(input_.grains, form, values), input_.p, I};
  }

  /// Growth over I of the two curves, and its sign over (I, μ_d/μ_0).
  Json signs() {
    int points = 0, outside = 0, agree_outside = 0, agree_inside = 0;
    double worst = 0.0;
    std::string csv = "form,I,mu_d_over_mu_0,C,incompressible,theory,expected,measured,agrees\n";
    const auto take = [&](const std::string& form, const SteadyShear& at, double I) {
      const double C = ill_posedness(at.response);
      const Rates r = measure(at, cell_of(at, at.wavelength_of(acoustic_share), cells_per_wave));
      const bool agrees = (C > 0.0) == (r.measured > 0.0);
      const bool counts = std::abs(at.fastest()) > neutral_margin;
      ++points;
      outside += counts ? 1 : 0;
      (counts ? agree_outside : agree_inside) += agrees ? 1 : 0;
      worst = std::max(worst, std::abs(r.measured - r.expected));
      csv += fmt::format("{},{},{},{},{},{},{},{},{}\n", form, I,
                         at.material->parameter("mu_d") / at.material->parameter("mu_0"), C,
                         at.fastest(), r.theory, r.expected, r.measured, agrees ? 1 : 0);
      return r;
    };
    Figure figure("Ill-posed flow of μ(I): growth of a wave in a Material Point shear cell",
                  fmt::format("eight cells to a wave, K = {} p; in units of ηk²/ρ", stiffness));
    figure.columns = 2;
    Axes& over_I = figure.add_axes();
    over_I.title = "lines: theory at the same K, points: measured";
    over_I.x = {"I", AxisScale::logarithmic};
    over_I.y = {"growth", AxisScale::linear, -0.25, 0.15};
    const auto numbers = decades(1e-3, 10.0, input_.quick ? 4 : 13);
    over_I.line("", std::vector{numbers.front(), numbers.back()}, std::vector{0.0, 0.0},
                {Colour::grey, 1.0});
    Json json;
    for (const auto& [form, colour] :
         {std::pair{"elastoviscoplastic", Colour::blue}, {"barker_gray", Colour::vermillion}}) {
      std::vector<double> theory, measured;
      try {
        for (const double I : numbers) {
          const Rates r = take(form, shear(form, I), I);
          theory.push_back(r.theory);
          measured.push_back(r.measured);
        }
      } catch (const InputError& error) {  // a curve that is nowhere well-posed has no I_1
        json[form] = {{"left_out", error.what()}};
        continue;
      }
      over_I.line("", numbers, theory, {colour, 1.2});
      over_I.points(form, numbers, measured, {colour, 1.0, Marker::circle, 5.0});
      json[form] = {{"most_growth", *std::max_element(measured.begin(), measured.end())}};
    }
    if (!input_.quick) {
      Axes& map = figure.add_axes();
      map.title = "colour: measured; rings: C > 0, ill-posed";
      map.x = {"I", AxisScale::logarithmic, 7e-4, 14.0};
      map.y.label = "μ_{d}/μ_{0}";
      map.legend = Legend::none;
      std::vector<double> x, y, z, ill_x, ill_y;
      for (const double ratio : {1.05, 1.3, 1.6, 2.0, 2.5, 3.0})
        for (const double I : decades(1e-3, 10.0, 9)) {
          const SteadyShear at = shear("elastoviscoplastic", I, stiffness, ratio);
          x.push_back(I);
          y.push_back(ratio);
          z.push_back(std::clamp(take("elastoviscoplastic", at, I).measured, -0.1, 0.1));
          if (ill_posedness(at.response) <= 0.0) continue;
          ill_x.push_back(I);
          ill_y.push_back(ratio);
        }
      map.scatter(x, y, z, Axis{"growth", AxisScale::linear, -0.1, 0.1}, {10.0, {}});
      map.points("", ill_x, ill_y, {Colour::black, 1.0, Marker::ring, 12.0});
    }
    out_.table("mu_i_shear_signs.csv", csv);
    out_.picture("mu_i_shear_signs.svg", figure);
    out_.tell(fmt::format(
        "mu_i: criterion and growth in a Material Point shear cell agree on the sign in {} of {} "
        "points outside the margin; inside: {} of {}",
        agree_outside, outside, agree_inside, points - outside));
    json["points"] = points;
    json["outside_margin"] = outside;
    json["agree_outside_margin"] = agree_outside;
    json["agree_inside_margin"] = agree_inside;
    json["largest_difference_from_expected"] = worst;
    return json;
  }

  Json refinement() {
    Figure figure("Growth in a Material Point shear cell under refinement",
                  fmt::format("p = {:g} Pa; points: measured", input_.p));
    figure.columns = 2;
    csv_ =
        "series,form,I,K_over_p,cells,h_over_d,wavelength_over_d,theory,expected,measured,"
        "measured_over_shear_rate\n";
    Json json;
    json["fixed_wavelength"] = fixed_wavelength(figure.add_axes());
    Axes& growing = figure.add_axes();
    json["fixed_cells"] = fixed_cells(growing, figure.add_axes());
    json["noise"] = noise(figure.add_axes());
    out_.table("mu_i_shear_refinement.csv", csv_);
    out_.picture("mu_i_shear_refinement.svg", figure);
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
  Json fixed_wavelength(Axes& axes) {
    axes.title = fmt::format("one wave, ηk²/ρ = {} ck", acoustic_share);
    axes.x.label = "cells to the wavelength";
    axes.y.label = "rate over that of theory";
    Json json = Json::array();
    for (const auto& [I, colour] : {std::pair{0.01, Colour::vermillion}, {0.1, Colour::blue}}) {
      const SteadyShear at = shear("elastoviscoplastic", I);
      std::vector<double> x, expected, measured;
      for (const int cells : input_.quick ? std::vector{6, 8} : std::vector{6, 8, 12, 16}) {
        const mpm::ShearCell cell = cell_of(at, at.wavelength_of(acoustic_share), cells);
        const Rates r = measure(at, cell);
        row("fixed_wavelength", "elastoviscoplastic", I, stiffness, at, cell, r);
        x.push_back(cells);
        expected.push_back(r.expected / r.theory);
        measured.push_back(r.measured / r.theory);
        json.push_back({{"I", I},
                        {"cells", cells},
                        {"measured_over_theory", measured.back()},
                        {"expected_over_theory", expected.back()}});
      }
      axes.dashed("", x, expected, {colour, 1.2});
      axes.points(fmt::format("I = {}", I), x, measured, {colour, 1.0, Marker::circle, 6.0});
    }
    return json;
  }

  /// Waves of eight cells: the finer the cells, the faster they grow, or decay.
  Json fixed_cells(Axes& growing, Axes& decaying) {
    growing.title = "ill-posed, I = 0.01: growth of waves of eight cells";
    decaying.title = "well-posed: decay of waves of eight cells";
    for (Axes* axes : {&growing, &decaying}) {
      axes->x = {"h/d", AxisScale::logarithmic};
      axes->y = {"rate/γ̇", AxisScale::logarithmic};
    }
    struct Case {
      Axes* axes;
      const char* form;
      double I, K_over_p;
      const char* name;
    };
    std::vector<Case> cases{{&growing, "elastoviscoplastic", 0.01, 2500.0, "K = 2500 p"},
                            {&decaying, "elastoviscoplastic", 0.1, 2500.0, "μ(I), I = 0.1"}};
    if (!input_.quick) {
      cases.push_back({&growing, "elastoviscoplastic", 0.01, 250.0, "K = 250 p"});
      cases.push_back({&decaying, "barker_gray", 0.1, 2500.0, "barker_gray, I = 0.1"});
      cases.push_back({&decaying, "barker_gray", 0.01, 2500.0, "barker_gray, I = 0.01"});
    }
    Json json = Json::array();
    for (const Case& c : cases) try {
        const SteadyShear at = shear(c.form, c.I, c.K_over_p);
        const double longest = shear("elastoviscoplastic", c.I).wavelength_of(0.1);
        std::vector<double> x, y, theory;
        for (const double part :
             input_.quick ? std::vector{0.5, 0.25} : std::vector{1.0, 0.5, 0.25, 0.125, 0.0625}) {
          const mpm::ShearCell cell = cell_of(at, longest * part, cells_per_wave);
          const Rates r = measure(at, cell);
          const double rate = row("fixed_cells", c.form, c.I, c.K_over_p, at, cell, r);
          const double sign = c.axes == &growing ? 1.0 : -1.0;
          x.push_back(cell.wavelength / cell.cells / at.material->parameter("d"));
          y.push_back(sign * rate);
          theory.push_back(sign * rate * r.theory / r.measured);
          json.push_back({{"form", c.form},
                          {"I", c.I},
                          {"K_over_p", c.K_over_p},
                          {"h_over_d", x.back()},
                          {"rate_over_shear_rate", rate}});
        }
        const Colour colour = cycle_colour(c.axes->series().size() / 2);
        c.axes->line("", x, theory, {colour, 1.2});
        c.axes->points(c.name, x, y, {colour, 1.0, Marker::circle, 6.0});
      } catch (const InputError& error) {
        json.push_back({{"form", c.form}, {"left_out", error.what()}});
      }
    return json;
  }

  /// Noise on every point: where the flow is ill-posed it finds the fastest wave by itself.
  Json noise(Axes& axes) {
    axes.title = "noise; from right to left h, h/2, h/4";
    axes.x.label = "ηk²t/ρ of waves of eight cells of size h";
    axes.y.label = "ln of its size";
    Json json = Json::array();
    for (const auto& [I, colour] : {std::pair{0.01, Colour::vermillion}, {0.1, Colour::blue}}) {
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
        row("noise", "elastoviscoplastic", I, stiffness, at, cell,
            {std::nan(""), std::nan(""), rate / viscous});
        std::vector<double> time = growth.time;
        for (double& t : time) t *= at.viscous_rate(longest);
        axes.line(part == 1.0 ? fmt::format("I = {}", I) : "", time, growth.log_size,
                  {colour, 1.5});
        json.push_back({{"I", I},
                        {"h_over_d", cell.wavelength / cell.cells / at.material->parameter("d")},
                        {"rate_over_shear_rate", rate / at.flow.shear_rate}});
      }
    }
    return json;
  }

  const input::StabilityInput& input_;
  PartOutput& out_;
  std::string csv_;
};

}  // namespace

Json shear_cell(const input::StabilityInput& input, PartOutput& out) {
  return ShearCellMaps(input, out).run();
}

}  // namespace repose::report
