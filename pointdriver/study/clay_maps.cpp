#include "pointdriver/study/clay_maps.hpp"

#include "models/linearised_cam_clay.hpp"

namespace repose::point {
namespace {

InitialConditions conditions_of(const ClayStart& start) {
  InitialConditions given;
  given.p = start.p;
  given.ocr = start.ocr;
  return given;
}

/// Strain of a step, tension positive: ε_a = ε_v/3 + ε_q along y, ε_r = ε_v/3 − ε_q/2.
Sym<double, 6> strain_of(const ClayStep& step) {
  Sym<double, 6> e;
  e[0] = e[2] = -(step.eps_v / 3.0 - 0.5 * step.eps_q);
  e[1] = -(step.eps_v / 3.0 + step.eps_q);
  return e;
}

struct End {
  ClayOutcome outcome;
  Sym<double, 6> stress;
};

template <class L>
End drive(const typename L::template Params<double>& P, const InitialPoint& start,
          std::span<const ClayStep> steps, int substeps) {
  End end{{true, 0, std::numeric_limits<double>::quiet_NaN(), 0.0}, start.stress};
  typename L::template State<double> state{start.state[0], start.state[1]};
  double density = start.density;
  for (const ClayStep& step : steps)
    for (int k = 0; k < substeps && end.outcome.converged; ++k) {
      Increment<double, 6> inc;
      inc.strain = (1.0 / substeps) * strain_of(step);
      inc.dt = 1.0;
      inc.density = density = density * std::exp(-trace(inc.strain));
      StepWork<double> spent;
      const bool failed = L::update(P, inc, end.stress, state, &spent, &end.outcome.evaluations);
      end.outcome.converged = !failed;
      if constexpr (std::is_same_v<L, LinearisedCamClay>)
        end.outcome.converged = end.outcome.converged && !L::lost(state);
    }
  end.outcome.p = pressure(end.stress);
  return end;
}

/// The stress by the adaptive integrator; absent where it does not get to the end.
std::optional<Sym<double, 6>> reference(const LawInfo& law, std::span<const double> theta,
                                        const ClayStart& start, std::span<const ClayStep> steps) {
  PointTest test;
  test.initial = conditions_of(start);
  test.settings = {Method::adaptive, 1e-11};
  test.settings.energy = false;
  std::vector<LegSpec> legs;
  for (const ClayStep& step : steps) {
    const Sym<double, 6> e = strain_of(step);
    LegSpec leg;
    for (int c = 0; c < 6; ++c)
      leg.rows[static_cast<std::size_t>(c)] = strain_rate(c, c < 3 ? -e[c] : 0.0);
    leg.duration = 1.0;
    legs.push_back(leg);
  }
  test.path = custom_path(legs);
  Curve curve;
  if (simulate(law, theta, test, curve).status != Status::completed) return {};
  return curve.rows.back().stress;
}

template <class L>
End drive(std::span<const double> theta, const ClayStart& start, std::span<const ClayStep> steps,
          int substeps, ClayUpdate update) {
  const auto P = L::template Params<double>::from(theta);
  const InitialPoint point = L::initial(P, conditions_of(start));
  if (update == ClayUpdate::exact) return drive<L>(P, point, steps, substeps);
  std::vector<double> values(theta.begin(), theta.end());
  const double v = P.rho_p / point.density;
  for (const std::size_t i : {std::size_t{1}, std::size_t{2}})  // λ, κ
    values[i] *= L::kappa_star(P, v) / P.kappa;
  return drive<LinearisedCamClay>(
      LinearisedCamClay::Params<double>::from(std::span<const double>(values)), point, steps,
      substeps);
}

End drive_any(const LawInfo& law, std::span<const double> theta, const ClayStart& start,
              std::span<const ClayStep> steps, int substeps, ClayUpdate update) {
  if (law.name != "modified_cam_clay")
    throw InputError("name", "maps of Cam-Clay need modified_cam_clay");
  return law.option == "v-ln_p"
             ? drive<ModifiedCamClay<Compression::v_ln_p>>(theta, start, steps, substeps, update)
             : drive<ModifiedCamClay<Compression::ln_v_ln_p>>(theta, start, steps, substeps,
                                                              update);
}

ClayOutcome judged(const End& end, const std::optional<Sym<double, 6>>& exact) {
  ClayOutcome outcome = end.outcome;
  if (outcome.converged && exact) {
    const Sym<double, 6> miss = end.stress - *exact;
    outcome.error = std::sqrt(contract(miss, miss) / contract(*exact, *exact));
  }
  return outcome;
}

}  // namespace

ClayOutcome drive_clay(const LawInfo& law, std::span<const double> theta, const ClayStart& start,
                       std::span<const ClayStep> steps, int substeps, ClayUpdate update) {
  return judged(drive_any(law, theta, start, steps, substeps, update),
                reference(law, theta, start, steps));
}

std::vector<ClayCell> clay_step_map(const LawInfo& law, std::span<const double> theta,
                                    std::span<const ClayStart> starts,
                                    std::span<const ClayStep> steps) {
  std::vector<ClayCell> cells;
  for (const ClayStart& start : starts)
    for (const ClayStep& step : steps) {
      const std::span<const ClayStep> one(&step, 1);
      const auto exact = reference(law, theta, start, one);
      for (const ClayUpdate update : {ClayUpdate::exact, ClayUpdate::linearised})
        cells.push_back(
            {start, step, update, judged(drive_any(law, theta, start, one, 1, update), exact)});
    }
  return cells;
}

}  // namespace repose::point
