/// Maps of modified Cam-Clay's update: single steps and paths, exact and linearised.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "models/modified_cam_clay.hpp"
#include "pointdriver/study/clay_maps.hpp"
#include "report/stability/part.hpp"

namespace repose::report {
namespace {

using Json = nlohmann::ordered_json;
using point::ClayCell;
using point::ClayOutcome;
using point::ClayStart;
using point::ClayStep;
using point::ClayUpdate;

constexpr std::array updates{ClayUpdate::exact, ClayUpdate::linearised};
std::string name_of(ClayUpdate update) {
  return update == ClayUpdate::exact ? "exact" : "linearised";
}

/// log10 of an error as a map shows it; NaN where there is none.
double shown(const ClayOutcome& o) {
  return o.converged ? std::log10(std::max(o.error, 1e-12)) : std::nan("");
}

/// What the cells of one kind say together.
struct Tally {
  int cells = 0, converged = 0, most_evaluations = 0;
  std::vector<double> errors{};

  void include(const ClayOutcome& o) {
    ++cells;
    converged += o.converged ? 1 : 0;
    if (o.converged) most_evaluations = std::max(most_evaluations, o.evaluations);
    if (std::isfinite(o.error)) errors.push_back(o.error);
  }
  Json json() {
    Json j{{"cells", cells},
           {"share_converged", static_cast<double>(converged) / std::max(1, cells)},
           {"most_evaluations", most_evaluations}};
    if (errors.empty()) return j;
    std::sort(errors.begin(), errors.end());
    j["median_error"] = errors[errors.size() / 2];
    j["largest_error"] = errors.back();
    return j;
  }
};

class ClayMaps {
 public:
  ClayMaps(const input::StabilityInput& input, PartOutput& out)
      : input_(input),
        out_(out),
        law_(find_law(input.clay)),
        theta_(checked_parameters(input.clay)),
        kappa_(kappa_star(theta_)) {}

  Json run() {
    Json j{{"kappa", kappa_}};
    j["single_steps"] = single_steps();
    j["kappa_sweep"] = kappa_sweep();
    j["paths"] = paths();
    return j;
  }

 private:
  /// dε_v/d ln p of a swelling line at the pressure of the maps.
  double kappa_star(const std::vector<double>& theta) const {
    const double kappa = theta[2];
    if (law_.option != "v-ln_p") return kappa;
    const auto material = make_material(input_.clay);
    return kappa * material->density_at(input_.p, 1.0) / material->parameter("rho_p");
  }

  Json single_steps() {
    const int n = input_.quick ? 15 : 41;
    std::vector<ClayStep> steps;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        steps.push_back({3.0 * kappa_ * (2.0 * i / (n - 1) - 1.0), 6.0 * kappa_ * j / (n - 1)});
    const std::array<ClayStart, 3> starts{{{input_.p, 1.0}, {input_.p, 4.0}, {input_.p, 20.0}}};
    const auto cells = point::clay_step_map(law_, theta_, starts, steps);
    std::string csv = "ocr,p_over_p_c,eps_v,eps_q,update,converged,evaluations,error,p_Pa\n";
    for (const ClayCell& c : cells)
      csv += fmt::format("{},{},{},{},{},{},{},{},{}\n", c.start.ocr, 1.0 / c.start.ocr,
                         c.step.eps_v, c.step.eps_q, name_of(c.update), c.outcome.converged ? 1 : 0,
                         c.outcome.evaluations, c.outcome.error, c.outcome.p);
    out_.table("clay_steps.csv", csv);

    Figure figure("One step of modified Cam-Clay",
                  fmt::format("log_{{10}} of the stress error of a single update; crosses: no "
                              "result. κ = {:.3g}",
                              kappa_));
    figure.columns = 3;
    figure.panel_width_px = figure.panel_height_px = 260.0;
    Json json;
    for (const ClayUpdate update : updates)
      for (const ClayStart& start : starts) {
        Axes& axes = figure.add_axes();
        axes.title = fmt::format("{}, OCR {}", name_of(update), start.ocr);
        axes.x.label = "Δε_{v}/κ, compression positive";
        axes.y.label = "Δε_{q}/κ";
        std::vector<double> x, y, z;
        Tally tally, gentle;
        for (const ClayCell& c : cells) {
          if (c.update != update || c.start.ocr != start.ocr) continue;
          x.push_back(c.step.eps_v / kappa_);
          y.push_back(c.step.eps_q / kappa_);
          z.push_back(shown(c.outcome));
          tally.include(c.outcome);
          if (c.step.eps_v < kappa_) gentle.include(c.outcome);
        }
        ScatterStyle style;
        style.diameter = 6.0 / (n - 1);
        axes.scatter(x, y, z, Axis{"log_{10} error", AxisScale::linear, -12.0, 0.0}, style);
        Json j = tally.json();
        j["share_converged_below_kappa"] = gentle.json()["share_converged"];
        json[name_of(update)][fmt::format("ocr_{}", start.ocr)] = j;
      }
    out_.picture("clay_steps.svg", figure);
    return json;
  }

  /// The same compression for soft and stiff swelling: what decides is Δε_v over κ.
  Json kappa_sweep() {
    const std::array factors{0.1, 1.0, 10.0};
    const auto strains = decades(1e-2 * kappa_, 10.0 * kappa_, input_.quick ? 13 : 41);
    std::string csv = "kappa,eps_v,update,converged,evaluations,error\n";
    Figure figure("One step in compression and shear, Δε_{q} = Δε_{v}, from the yield surface",
                  "a line ends where the update has no result");
    figure.columns = 2;
    Json json;
    std::array<Axes*, 2> axes{&figure.add_axes(), &figure.add_axes()};
    for (std::size_t u = 0; u < updates.size(); ++u) {
      axes[u]->title = name_of(updates[u]);
      axes[u]->x = {"Δε_{v}/κ", AxisScale::logarithmic};
      axes[u]->y = {"stress error (relative)", AxisScale::logarithmic, 1e-6, 10.0};
    }
    for (const double factor : factors) {
      std::vector<double> theta = theta_;
      theta[2] *= factor;
      if (!(theta[2] < 0.9 * theta[1])) continue;  // κ < λ
      // N follows λ − κ at constant Γ
      theta = checked_parameters(with_kappa(theta[2]));
      const double kappa = kappa_ * factor;
      for (std::size_t u = 0; u < updates.size(); ++u) {
        std::vector<double> x, y;
        double first_lost = std::nan("");
        for (const double eps : strains) {
          const ClayStep step{eps * factor, eps * factor};
          const ClayOutcome o =
              point::drive_clay(law_, theta, {input_.p, 1.0}, {&step, 1}, 1, updates[u]);
          csv += fmt::format("{},{},{},{},{},{}\n", kappa, step.eps_v, name_of(updates[u]),
                             o.converged ? 1 : 0, o.evaluations, o.error);
          x.push_back(step.eps_v / kappa);
          y.push_back(o.converged ? o.error : std::nan(""));
          if (!o.converged && std::isnan(first_lost)) first_lost = step.eps_v / kappa;
        }
        axes[u]->line(fmt::format("κ = {:.2g}", kappa), x, y);
        json[name_of(updates[u])][fmt::format("kappa_{:.2g}", kappa)] =
            Json{{"first_lost_in_kappa", std::isnan(first_lost) ? Json() : Json(first_lost)}};
      }
    }
    out_.table("clay_kappa.csv", csv);
    out_.picture("clay_kappa.svg", figure);
    return json;
  }

  LawSpec with_kappa(double kappa) const {
    LawSpec spec = input_.clay;
    spec.values["kappa"] = kappa;
    if (spec.values.contains("Gamma")) spec.values.erase("N");
    return spec;
  }

  Json paths() {
    struct Path {
      std::string key, title;
      std::vector<ClayStep> steps;
    };
    const std::array<Path, 2> all{{{"undrained", "undrained shear by 50 κ", {{0.0, 50.0 * kappa_}}},
                                   {"to_zero_and_back",
                                    "p down to p e^{−6} and back",
                                    {{-6.0 * kappa_, 0.0}, {6.0 * kappa_, 0.0}}}}};
    std::vector<int> counts;
    for (int n = 1; n <= (input_.quick ? 64 : 1024); n *= 2) counts.push_back(n);
    const auto ratios = decades(1.0, 32.0, input_.quick ? 6 : 11);
    std::string csv = "path,ocr,steps,update,converged,evaluations,error,p_Pa\n";
    Figure figure("Paths of modified Cam-Clay in equal steps",
                  "log_{10} of the stress error at the end; crosses: no result");
    figure.columns = 2;
    figure.panel_width_px = 320.0;
    figure.panel_height_px = 240.0;
    Json json;
    for (const ClayUpdate update : updates)
      for (const Path& path : all) {
        Axes& axes = figure.add_axes();
        axes.title = fmt::format("{}: {}", name_of(update), path.title);
        axes.x = {"steps per leg", AxisScale::logarithmic, 0.7, 1.4 * counts.back()};
        axes.y = {"OCR", AxisScale::logarithmic, 0.85, 38.0};
        std::vector<double> x, y, z;
        Tally tally;
        for (const double ocr : ratios)
          for (const int n : counts) {
            const ClayOutcome o =
                point::drive_clay(law_, theta_, {input_.p, ocr}, path.steps, n, update);
            csv += fmt::format("{},{},{},{},{},{},{},{}\n", path.key, ocr, n, name_of(update),
                               o.converged ? 1 : 0, o.evaluations, o.error, o.p);
            x.push_back(n);
            y.push_back(ocr);
            z.push_back(shown(o));
            tally.include(o);
          }
        ScatterStyle style;
        style.marker_px = 14.0;
        axes.scatter(x, y, z, Axis{"log_{10} error", AxisScale::linear, -12.0, 0.0}, style);
        json[path.key][name_of(update)] = tally.json();
      }
    out_.table("clay_paths.csv", csv);
    out_.picture("clay_paths.svg", figure);
    return json;
  }

  const input::StabilityInput& input_;
  PartOutput& out_;
  const LawInfo& law_;
  std::vector<double> theta_;
  double kappa_;
};

}  // namespace

Json map_clay(const input::StabilityInput& input, PartOutput& out) {
  Json j = ClayMaps(input, out).run();
  const auto share = [&](const char* update) {
    double least = 1.0;
    for (const auto& [key, value] : j["single_steps"][update].items())
      least = std::min(least, value["share_converged"].get<double>());
    return 100.0 * least;
  };
  out.tell(
      fmt::format("clay: single steps with a result, at least {:.4g} % exact, {:.4g} % "
                  "linearised",
                  share("exact"), share("linearised")));
  return j;
}

}  // namespace repose::report
