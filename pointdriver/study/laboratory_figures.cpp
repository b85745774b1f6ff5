#include "pointdriver/study/laboratory_figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "models/cone.hpp"

namespace repose::point {
namespace {

const double nan = std::numeric_limits<double>::quiet_NaN();

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// Principal effective stresses, compression positive, σ_1 ≥ σ_2 ≥ σ_3, by the invariants of the
/// deviator: σ_k = p + 2√(J_2/3) cos(θ − 2πk/3), cos 3θ = (3√3/2) J_3/J_2^{3/2}.
std::array<double, 3> principal(const Sym<double, 6>& stress) {
  const double p = pressure(stress);
  const Sym<double, 6> s = deviator(stress);
  const double root = shear_norm(s);  // √J_2
  if (!(root > 0.0)) return {p, p, p};
  const double theta = std::acos(cone::cos_3_theta(s)) / 3.0;
  const auto part = [&](int k) {
    return p + 2.0 * root / std::sqrt(3.0) * std::cos(theta - 2.0 * std::numbers::pi * k / 3.0);
  };
  std::array<double, 3> sigma{part(0), part(1), part(2)};
  std::sort(sigma.begin(), sigma.end(), std::greater<>());
  return sigma;
}

After after_largest(const std::vector<double>& values) {
  const double most = *std::max_element(values.begin(), values.end());
  if (values.back() < 0.99 * most) return After::peak;
  const std::size_t before = values.size() - 1 - values.size() / 10;
  if (before + 1 == values.size()) return After::rising;
  return values.back() < 1.01 * values[before] ? After::plateau : After::rising;
}

bool at_constant_volume(const LegSpec& leg) {
  return (leg.kind == Kind::triaxial && leg.condition == Condition::undrained) ||
         (leg.kind == Kind::simple_shear && leg.condition == Condition::constant_volume);
}

bool shears(const LegSpec& leg) {
  return leg.kind == Kind::triaxial || leg.kind == Kind::simple_shear || leg.kind == Kind::custom;
}

bool compresses(const LegSpec& leg) {
  return leg.kind == Kind::oedometer || leg.kind == Kind::isotropic;
}

bool of_triaxial_cell(const LegSpec& leg) {
  return leg.kind == Kind::triaxial &&
         (leg.condition == Condition::drained || leg.condition == Condition::undrained);
}

/// Rows of a stage, or of one of its legs; the first is the state in which it begins.
struct StageRows {
  int number = 0;
  std::size_t first_leg = 0, start = 0, end = 0;  ///< rows start … end − 1
};

class Reader {
 public:
  Reader(const LawInfo& law, std::span<const double> theta, const PointTest& test,
         const Curve& curve)
      : law_(law),
        theta_(theta),
        test_(test),
        curve_(curve) {
    const std::vector<Path::Place> places = test.path.places();
    for (std::size_t row = 0; row < curve.rows.size(); ++row) {
      const auto leg = static_cast<std::size_t>(curve.rows[row].leg);
      const int stage = places[leg].stage;
      if (stages_.empty() || stages_.back().number != stage)
        stages_.push_back({stage, leg, row == 0 ? 0 : row - 1, row});
      if (legs_.empty() || legs_.back().first_leg != leg)
        legs_.push_back({stage, leg, row == 0 ? 0 : row - 1, row});
      stages_.back().end = legs_.back().end = row + 1;
    }
  }

  LaboratoryFigures figures(std::span<const double> secants_at) {
    LaboratoryFigures all;
    all.undrained = undrained_strength();
    all.friction = friction();
    if (law_.has_stress_memory) {
      all.stiffness = stiffness();
      for (const StageRows& stage : stages_)
        if (leg(stage).kind == Kind::triaxial || leg(stage).kind == Kind::simple_shear)
          secants(stage, secants_at, all.secants);
    }
    double largest = carried_before();
    for (const StageRows& stage : stages_)
      if (compresses(leg(stage))) {
        all.oedometer |= leg(stage).kind == Kind::oedometer;
        branches(stage, largest, all.compression);
      }
    return all;
  }

 private:
  const LegSpec& leg(const StageRows& stage) const {
    return test_.path.legs[stage.first_leg].spec();
  }

  std::vector<double> column(Quantity quantity, const Curve& curve) const {
    std::vector<double> values;
    read_column(law_, theta_, test_, curve, quantity, values);
    return values;
  }
  const std::vector<double>& column(Quantity quantity) {
    std::vector<double>& values = columns_[static_cast<std::size_t>(quantity)];
    if (values.empty()) values = column(quantity, curve_);
    return values;
  }

  const StageRows& stage_of(const StageRows& leg) const {
    return *std::find_if(stages_.begin(), stages_.end(),
                         [&](const StageRows& stage) { return stage.number == leg.number; });
  }

  /// A normal strain of the stage as the test measures strains, from logarithmic ones.
  double measured_strain(double logarithmic) const {
    return test_.path.measure == StrainMeasure::logarithmic ? logarithmic
                                                            : -std::expm1(-logarithmic);
  }

  /// The strain that a stage of this kind is plotted over, from its start.
  double strain(const StageRows& stage, std::size_t row) {
    const auto axial = [&](std::size_t k) { return -curve_.rows[k].strain[1]; };
    switch (leg(stage).kind) {
      case Kind::triaxial:
        return measured_strain(axial(row) - axial(stage.start));
      case Kind::simple_shear:
        return column(Quantity::gamma)[row] - column(Quantity::gamma)[stage.start];
      default:
        return column(Quantity::eps_q)[row] - column(Quantity::eps_q)[stage.start];
    }
  }

  /// q of a triaxial leg and τ of a sheared one, positive in the sense in which it is sheared: that
  /// of the largest change from its start. Of the rows after the start.
  std::vector<double> sheared(const StageRows& rows) {
    const auto& stress = column(leg(rows).kind == Kind::simple_shear ? Quantity::tau : Quantity::q);
    double most = 0.0;
    for (std::size_t row = rows.start + 1; row < rows.end; ++row)
      if (std::abs(stress[row] - stress[rows.start]) > std::abs(most))
        most = stress[row] - stress[rows.start];
    std::vector<double> values;
    for (std::size_t row = rows.start + 1; row < rows.end; ++row)
      values.push_back(most < 0.0 ? -stress[row] : stress[row]);
    return values;
  }

  std::optional<UndrainedStrength> undrained_strength() {
    std::optional<UndrainedStrength> best;
    for (const StageRows& rows : legs_) {
      if (!at_constant_volume(leg(rows)) || rows.end < rows.start + 2) continue;
      const bool triaxial = leg(rows).kind == Kind::triaxial;
      std::vector<double> shear = sheared(rows);
      for (double& x : shear) x *= triaxial ? 0.5 : 1.0;
      const auto largest = std::max_element(shear.begin(), shear.end());
      if (!(*largest > 0.0) || (best && *largest <= best->S_u)) continue;
      const StageRows& stage = stage_of(rows);
      const std::size_t row = rows.start + 1 + static_cast<std::size_t>(largest - shear.begin());
      best = {rows.number, *largest, strain(stage, row), after_largest(shear),
              triaxial ? skempton(stage, row) : nan};
    }
    return best;
  }

  /// The total radial stress is kept: in compression Δσ_3 = 0 and Δσ_1 = Δq, in extension
  /// Δσ_1 = 0 and Δσ_3 = Δq.
  double skempton(const StageRows& stage, std::size_t row) {
    const double dq = column(Quantity::q)[row] - column(Quantity::q)[stage.start];
    const double du = column(Quantity::u)[row] - column(Quantity::u)[stage.start];
    if (dq == 0.0) return nan;
    return dq > 0.0 ? du / dq : (du - dq) / -dq;
  }

  std::optional<Friction> friction() {
    std::optional<Friction> best;
    std::size_t last = 0;
    bool plane_strain = true, tension = false, in_shear = true;
    double on_plane = 0.0;
    for (const StageRows& rows : legs_) {
      const LegSpec& spec = leg(rows);
      if (!shears(spec) || rows.end < rows.start + 2) continue;
      in_shear = in_shear && spec.kind == Kind::simple_shear;
      const std::vector<double> sense =
          spec.kind == Kind::custom ? std::vector<double>() : sheared(rows);
      std::vector<double> angles;
      std::size_t at = 0;
      double peak = -1.0;
      for (std::size_t row = rows.start + 1; row < rows.end; ++row) {
        last = row;
        if (spec.kind == Kind::simple_shear)
          on_plane = std::max(on_plane, degrees(std::atan2(std::abs(column(Quantity::tau)[row]),
                                                           column(Quantity::sigma_a)[row])));
        else
          plane_strain = plane_strain && spec.kind == Kind::custom && smallest_strain(row) < 1e-12;
        const double angle = friction_angle(row);
        tension = tension || std::isnan(angle);
        // what the start leaves in the other sense is not mobilised by this shear
        if (std::isnan(angle) || (!sense.empty() && sense[row - rows.start - 1] < 0.0)) continue;
        angles.push_back(angle);
        if (angle > peak) {
          peak = angle;
          at = row;
        }
      }
      if (angles.empty() || (best && peak <= best->peak)) continue;
      best.emplace();
      best->stage = rows.number;
      best->peak = peak;
      best->strain = strain(stage_of(rows), at);
      best->after = after_largest(angles);
    }
    if (!best) return best;
    best->tension = tension;
    best->end = friction_angle(last);
    best->on_plane = in_shear ? on_plane : nan;
    const LegSpec& spec = test_.path.legs[static_cast<std::size_t>(curve_.rows[last].leg)].spec();
    const std::array<double, 3> s = principal(curve_.rows[last].stress);
    if (spec.kind == Kind::triaxial)
      best->b = column(Quantity::q)[last] < 0.0 ? 1.0 : 0.0;
    else if (plane_strain)
      best->b = 0.5;  // associated flow at constant volume and no strain along: s_zz = 0
    else
      best->b = s[0] > s[2] ? (s[1] - s[2]) / (s[0] - s[2]) : nan;
    best->critical = critical_friction_angle(critical_ratio(best->b), best->b);
    return best;
  }

  /// Mobilised in a row; NaN in tension.
  double friction_angle(std::size_t row) const {
    const std::array<double, 3> s = principal(curve_.rows[row].stress);
    if (!(s[2] >= 0.0) || !(s[0] > 0.0)) return nan;
    return degrees(std::asin((s[0] - s[2]) / (s[0] + s[2])));
  }

  /// The smallest normal strain of a row: 0 where a direction is kept from straining.
  double smallest_strain(std::size_t row) const {
    const Sym<double, 6>& e = curve_.rows[row].strain;
    return std::min({std::abs(e[0]), std::abs(e[1]), std::abs(e[2])});
  }

  double parameter(std::string_view name) const {
    const int i = parameter_index(law_.parameters, name);
    return i < 0 ? nan : theta_[static_cast<std::size_t>(i)];
  }

  /// q/p of the law's critical state at the intermediate stress b: M of clays, √3 μ_0 of grains as
  /// they come to rest, on their cone.
  double critical_ratio(double b) const {
    double M = parameter("M");
    if (std::isnan(M)) M = std::sqrt(3.0) * parameter("mu_0");
    if (std::isnan(M) || std::isnan(b)) return M;
    return M * cone::share(parameter("shape"), M, deviator(Sym<double, 6>{{-1.0, -b, 0.0}}));
  }

  /// The stage driven again up to each goal in turn, quantities that rise with the driver's (q,
  /// ε_q, γ): the row in which it begins, and one for each goal, as far as it comes.
  Curve located(const StageRows& stage, const std::vector<Goal>& goals) const {
    PointTest again = test_;
    again.path.legs.clear();
    for (std::size_t i = 0; i < stage.first_leg; ++i) {
      LegSpec before = test_.path.legs[i].spec();
      before.points = 1;
      again.path.legs.emplace_back(before);
    }
    for (const Goal& goal : goals) {
      LegSpec spec = leg(stage);
      spec.goal = goal;
      spec.goal_falls = false;  // the stage's own may fall: σ_r at constant p
      spec.goal_is_event = true;
      spec.points = 1;
      spec.stops.clear();
      spec.continues = again.path.legs.size() > stage.first_leg;
      again.path.legs.emplace_back(spec);
    }
    Curve curve;
    simulate(law_, theta_, again, curve);
    std::size_t first = 1;  // row 0 is the start of the test
    while (first < curve.rows.size() &&
           static_cast<std::size_t>(curve.rows[first].leg) < stage.first_leg)
      ++first;
    Curve ends;
    if (first < curve.rows.size())
      ends.rows.assign(curve.rows.begin() + static_cast<std::ptrdiff_t>(first) - 1,
                       curve.rows.end());
    ends.outcome = curve.outcome;
    return ends;
  }

  std::optional<Stiffness> stiffness() {
    const StageRows* of = nullptr;
    double most = 0.0, q_half = 0.0;
    for (const StageRows& stage : stages_) {
      if (!of_triaxial_cell(leg(stage)) || leg(stage).driver < 0) continue;
      const auto& q = column(Quantity::q);
      for (std::size_t row = stage.start + 1; row < stage.end; ++row)
        if (std::abs(q[row] - q[stage.start]) > most) {
          most = std::abs(q[row] - q[stage.start]);
          q_half = 0.5 * (q[row] + q[stage.start]);
          of = &stage;
        }
    }
    if (of == nullptr) return std::nullopt;
    const Curve ends = located(*of, {Goal{Quantity::q, q_half}});
    if (ends.rows.size() < 2 || is_failure(ends.outcome.status)) return std::nullopt;
    const auto q = column(Quantity::q, ends);
    const double strained = measured_strain(ends.rows[0].strain[1] - ends.rows[1].strain[1]);
    return Stiffness{of->number, (q[1] - q[0]) / strained, strained};
  }

  void secants(const StageRows& stage, std::span<const double> at, std::vector<SecantShear>& all) {
    const LegSpec& spec = leg(stage);
    if (at.empty() || spec.driver < 0) return;
    const bool triaxial = spec.kind == Kind::triaxial;
    // γ = ε_a − ε_r = 3/2 ε_q
    const Quantity measure = triaxial ? Quantity::eps_q : Quantity::gamma;
    const double factor = triaxial ? 2.0 / 3.0 : 1.0;
    const std::size_t next = std::min(stage.start + 1, stage.end - 1);
    const double sign = column(measure)[next] < column(measure)[stage.start] ? -1.0 : 1.0;
    double reached = 0.0;
    for (std::size_t row = stage.start; row < stage.end; ++row)
      reached = std::max(reached, sign * (column(measure)[row] - column(measure)[stage.start]));
    for (const double gamma : at) {
      SecantShear secant{stage.number, gamma, nan};
      if (factor * gamma > reached * (1.0 + 1e-9)) {
        all.push_back(secant);
        continue;
      }
      const Curve ends = located(stage, {Goal{measure, sign * factor * gamma, true}});
      if (ends.rows.size() >= 2 && !is_failure(ends.outcome.status)) {
        const auto stress = column(triaxial ? Quantity::q : Quantity::tau, ends);
        secant.G = (triaxial ? 0.5 : 1.0) * (stress[1] - stress[0]) / (sign * gamma);
      }
      all.push_back(secant);
    }
  }

  /// e, ln p and K0 at x on the way from row `from` to `to`, between rows by ln x.
  struct At {
    double e = 0.0, ln_p = 0.0;
  };
  At at(const std::vector<double>& x, double wanted, std::size_t from, std::size_t to) {
    const auto& v = column(Quantity::v);
    const auto& p = column(Quantity::p);
    std::size_t row = from;
    while (row + 1 < to && (x[row + 1] - wanted) * (x[from] - wanted) > 0.0) ++row;
    const std::size_t next = std::min(row + 1, to);
    const double span = std::log(x[next] / x[row]);
    const double share = span == 0.0 ? 0.0 : std::log(wanted / x[row]) / span;
    const auto mix = [share](double a, double b) { return a + share * (b - a); };
    return {mix(v[row], v[next]) - 1.0, mix(std::log(p[row]), std::log(p[next]))};
  }

  /// The largest x of the branches before the test, as its start says; 0 where that is not known.
  double carried_before() {
    const InitialConditions& given = test_.initial;
    const auto first = std::find_if(stages_.begin(), stages_.end(),
                                    [&](const StageRows& stage) { return compresses(leg(stage)); });
    if (first == stages_.end()) return 0.0;
    const double sigma_a = column(Quantity::sigma_a).front(), p = column(Quantity::p).front();
    const bool over_p = leg(*first).kind == Kind::isotropic;
    if (over_p) return given.ocr ? *given.ocr * p : given.ocr_v ? nan : 0.0;
    if (given.ocr_v) return *given.ocr_v * sigma_a;
    return given.ocr && *given.ocr > 1.0 ? nan : 0.0;
  }

  void branches(const StageRows& stage, double& largest, std::vector<CompressionBranch>& all) {
    using Way = CompressionBranch::Way;
    const auto& x = column(leg(stage).kind == Kind::oedometer ? Quantity::sigma_a : Quantity::p);
    const auto& p_c = column(Quantity::p_c);
    const bool knows_yield = variable_index(law_, "p_c") >= 0;
    // NaN stays until virgin compression tells
    const auto carry = [&](double now, bool is_virgin) {
      largest = std::isnan(largest) && !is_virgin ? largest : std::fmax(largest, now);
    };
    carry(x[stage.start], false);
    const auto way_of = [&](std::size_t row) {
      if (x[row] < x[row - 1]) return Way::unloading;
      const bool yields = knows_yield ? p_c[row] > p_c[row - 1] * (1.0 + 1e-9) : x[row] > largest;
      return yields ? Way::virgin : Way::reloading;
    };
    std::size_t from = stage.start;
    while (from + 1 < stage.end) {
      const Way way = way_of(from + 1);
      std::size_t to = from + 1;
      carry(x[to], way == Way::virgin);
      while (to + 1 < stage.end && way_of(to + 1) == way) carry(x[++to], way == Way::virgin);
      if (x[from] > 0.0 && x[to] > 0.0 && std::abs(std::log(x[to] / x[from])) > 1e-9)
        all.push_back(branch(stage, way, x, from, to, largest));
      from = to;
    }
  }

  CompressionBranch branch(const StageRows& stage, CompressionBranch::Way way,
                           const std::vector<double>& x, std::size_t from, std::size_t to,
                           double largest) {
    CompressionBranch b{stage.number, way, x[from], x[to]};
    const bool is_virgin = way == CompressionBranch::Way::virgin;
    // the first interval of a virgin branch may begin before yield
    const double begin =
        is_virgin ? std::max(x[to > from + 1 ? from + 1 : from], 0.5 * x[to]) : x[from];
    const At first = at(x, begin, from, to), last = at(x, x[to], from, to);
    const double ln_x = std::log(x[to] / begin);
    // one interval in which yield lies is neither
    const bool mixed = is_virgin && to == from + 1 && from > stage.start;
    b.C = mixed ? nan : (first.e - last.e) / ln_x * std::numbers::ln10;
    b.p_over_x = (last.ln_p - first.ln_p) / ln_x;
    b.K0 = column(Quantity::sigma_r)[to] / column(Quantity::sigma_a)[to];
    b.OCR = std::isnan(largest) ? nan : std::max(1.0, largest / x[to]);
    b.C_over_kappa = nan;
    if (const int i = parameter_index(law_.parameters, "kappa"); i >= 0 && !is_virgin) {
      const double v = law_.option == "v-ln_p" ? 1.0 : 1.0 + 0.5 * (first.e + last.e);
      b.C_over_kappa = b.C / (theta_[static_cast<std::size_t>(i)] * v * std::numbers::ln10);
    }
    return b;
  }

  const LawInfo& law_;
  std::span<const double> theta_;
  const PointTest& test_;
  const Curve& curve_;
  std::vector<StageRows> stages_, legs_;
  std::array<std::vector<double>, quantity_count> columns_;
};

}  // namespace

double critical_friction_angle(double M, double b) {
  const double difference = M / std::sqrt(1.0 - b + b * b);  // (σ_1 − σ_3)/p
  const double sine = difference / (2.0 + difference * (1.0 - 2.0 * b) / 3.0);
  return sine >= 0.0 && sine <= 1.0 ? degrees(std::asin(sine)) : nan;
}

LaboratoryFigures laboratory_figures(const LawInfo& law, std::span<const double> theta,
                                     const PointTest& test, const Curve& curve,
                                     std::span<const double> secants_at) {
  if (curve.rows.empty()) return {};
  return Reader(law, theta, test, curve).figures(secants_at);
}

}  // namespace repose::point
