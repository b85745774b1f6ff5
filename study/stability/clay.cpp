#include "study/stability/clay.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "models/modified_cam_clay.hpp"

namespace repose::study {
namespace {

using Json = io::Json;
using point::ClayCell;
using point::ClayOutcome;
using point::ClayStart;
using point::ClayStep;
using point::ClayUpdate;

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

class MapOfClay {
 public:
  explicit MapOfClay(const input::StabilityInput& input)
      : input_(input),
        law_(find_law(input.clay)),
        theta_(checked_parameters(input.clay)),
        kappa_(kappa_star(theta_)) {}

  ClayMaps run() {
    maps_.kappa = kappa_;
    maps_.figures = Json{{"kappa", kappa_}};
    maps_.figures["single_steps"] = single_steps();
    maps_.figures["kappa_sweep"] = kappa_sweep();
    maps_.figures["paths"] = paths();
    return std::move(maps_);
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
    maps_.cells_across = static_cast<std::size_t>(n);
    maps_.starts = {{input_.p, 1.0}, {input_.p, 4.0}, {input_.p, 20.0}};
    maps_.steps = point::clay_step_map(law_, theta_, maps_.starts, steps);
    std::string csv = "ocr,p_over_p_c,eps_v,eps_q,update,converged,evaluations,error,p_Pa\n";
    for (const ClayCell& c : maps_.steps)
      csv += fmt::format("{},{},{},{},{},{},{},{},{}\n", c.start.ocr, 1.0 / c.start.ocr,
                         c.step.eps_v, c.step.eps_q, name_of(c.update), c.outcome.converged ? 1 : 0,
                         c.outcome.evaluations, c.outcome.error, c.outcome.p);
    maps_.tables.push_back({"clay_steps", csv});
    Json json;
    for (const ClayUpdate update : clay_updates)
      for (const ClayStart& start : maps_.starts) {
        Tally tally, gentle;
        for (const ClayCell& c : maps_.steps) {
          if (c.update != update || c.start.ocr != start.ocr) continue;
          tally.include(c.outcome);
          if (c.step.eps_v < kappa_) gentle.include(c.outcome);
        }
        Json j = tally.json();
        j["share_converged_below_kappa"] = gentle.json()["share_converged"];
        json[name_of(update)][fmt::format("ocr_{}", start.ocr)] = j;
      }
    return json;
  }

  /// The same compression for soft and stiff swelling: what decides is Δε_v over κ.
  Json kappa_sweep() {
    const std::array factors{0.1, 1.0, 10.0};
    const auto strains = decades(1e-2 * kappa_, 10.0 * kappa_, input_.quick ? 13 : 41);
    std::string csv = "kappa,eps_v,update,converged,evaluations,error\n";
    Json json;
    for (const double factor : factors) {
      std::vector<double> theta = theta_;
      theta[2] *= factor;
      if (!(theta[2] < 0.9 * theta[1])) continue;  // κ < λ
      // N follows λ − κ at constant Γ
      theta = checked_parameters(with_kappa(theta[2]));
      const double kappa = kappa_ * factor;
      for (const ClayUpdate update : clay_updates) {
        ClaySweep sweep{kappa, update, {}, {}};
        double first_lost = std::nan("");
        for (const double eps : strains) {
          const ClayStep step{eps * factor, eps * factor};
          const ClayOutcome o =
              point::drive_clay(law_, theta, {input_.p, 1.0}, {&step, 1}, 1, update);
          csv += fmt::format("{},{},{},{},{},{}\n", kappa, step.eps_v, name_of(update),
                             o.converged ? 1 : 0, o.evaluations, o.error);
          sweep.strain.push_back(step.eps_v / kappa);
          sweep.error.push_back(o.converged ? o.error : std::nan(""));
          if (!o.converged && std::isnan(first_lost)) first_lost = step.eps_v / kappa;
        }
        maps_.sweeps.push_back(std::move(sweep));
        json[name_of(update)][fmt::format("kappa_{:.2g}", kappa)] =
            Json{{"first_lost_in_kappa", std::isnan(first_lost) ? Json() : Json(first_lost)}};
      }
    }
    maps_.tables.push_back({"clay_kappa", csv});
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
    maps_.most_steps = counts.back();
    Json json;
    for (const ClayUpdate update : clay_updates)
      for (const Path& path : all) {
        ClayPath mapped{path.title, update, {}, {}, {}};
        Tally tally;
        for (const double ocr : ratios)
          for (const int n : counts) {
            const ClayOutcome o =
                point::drive_clay(law_, theta_, {input_.p, ocr}, path.steps, n, update);
            csv += fmt::format("{},{},{},{},{},{},{},{}\n", path.key, ocr, n, name_of(update),
                               o.converged ? 1 : 0, o.evaluations, o.error, o.p);
            mapped.steps.push_back(n);
            mapped.ocr.push_back(ocr);
            mapped.outcomes.push_back(o);
            tally.include(o);
          }
        maps_.paths.push_back(std::move(mapped));
        json[path.key][name_of(update)] = tally.json();
      }
    maps_.tables.push_back({"clay_paths", csv});
    return json;
  }

  const input::StabilityInput& input_;
  const LawInfo& law_;
  std::vector<double> theta_;
  double kappa_;
  ClayMaps maps_;
};

}  // namespace

std::string name_of(ClayUpdate update) {
  return update == ClayUpdate::exact ? "exact" : "linearised";
}

ClayMaps map_clay(const input::StabilityInput& input) { return MapOfClay(input).run(); }

namespace {

double least_share(const io::Json& cells) {
  double least = 1.0;
  for (const auto& [key, value] : cells.items())
    least = std::min(least, value["share_converged"].get<double>());
  return 100.0 * least;
}

}  // namespace

std::string words_of(const ClayMaps& maps) {
  const io::Json& steps = maps.figures["single_steps"];
  return fmt::format(
      "clay: single steps with a result, at least {:.4g} % exact, {:.4g} % linearised",
      least_share(steps["exact"]), least_share(steps["linearised"]));
}

}  // namespace repose::study
