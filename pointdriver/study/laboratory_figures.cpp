#include "pointdriver/study/laboratory_figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace repose::point {
namespace {

const double nan = std::numeric_limits<double>::quiet_NaN();

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// Principal effective stresses, compression positive, σ_1 ≥ σ_2 ≥ σ_3, by the invariants of the
/// deviator: σ_k = p + 2√(J_2/3) cos(θ − 2πk/3), cos 3θ = (3√3/2) J_3/J_2^{3/2}.
std::array<double, 3> principal(const Sym<double, 6>& stress) {
  const double p = pressure(stress);
  Sym<double, 6> s = deviator(stress);
  for (double& x : s.c) x = -x;
  const double root = shear_norm(s);  // √J_2
  if (!(root > 0.0)) return {p, p, p};
  const double J3 = s[0] * (s[1] * s[2] - s[4] * s[4]) - s[3] * (s[3] * s[2] - s[4] * s[5]) +
                    s[5] * (s[3] * s[4] - s[1] * s[5]);
  const double cosine = 1.5 * std::sqrt(3.0) * J3 / (root * root * root);
  const double theta = std::acos(std::clamp(cosine, -1.0, 1.0)) / 3.0;
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

/// The rows of a stage; the first is the state in which it begins.
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
      stages_.back().end = row + 1;
    }
  }

  LaboratoryFigures figures(std::span<const double> secants_at) {
    LaboratoryFigures all;
    all.undrained = undrained_strength();
    all.friction = friction();
    all.stiffness = stiffness();
    for (const StageRows& stage : stages_)
      if (of_triaxial_cell(leg(stage)) || leg(stage).kind == Kind::simple_shear)
        secants(stage, secants_at, all.secants);
    double largest = 0.0;
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

  /// The strain that a stage of this kind is plotted over, from its start.
  double strain(const StageRows& stage, std::size_t row) {
    const Kind kind = leg(stage).kind;
    const Quantity q = kind == Kind::simple_shear ? Quantity::gamma
                       : kind == Kind::triaxial   ? Quantity::eps_a
                                                  : Quantity::eps_q;
    const double x = column(q)[row] - column(q)[stage.start];
    return kind == Kind::simple_shear ? std::abs(x) : x;
  }

  std::optional<UndrainedStrength> undrained_strength() {
    std::vector<double> shear;
    std::optional<UndrainedStrength> best;
    for (const StageRows& stage : stages_) {
      if (!at_constant_volume(leg(stage))) continue;
      const bool triaxial = leg(stage).kind == Kind::triaxial;
      const auto& stress = column(triaxial ? Quantity::q : Quantity::tau);
      for (std::size_t row = stage.start; row < stage.end; ++row) {
        shear.push_back((triaxial ? 0.5 : 1.0) * std::abs(stress[row]));
        if (best && shear.back() <= best->S_u) continue;
        best = {shear.back(), strain(stage, row), After::rising,
                triaxial ? skempton(stage, row) : nan};
      }
    }
    if (best) best->after = after_largest(shear);
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
    std::vector<double> angles;
    std::optional<Friction> best;
    std::size_t last = 0;
    bool plane_strain = true;
    for (const StageRows& stage : stages_) {
      const LegSpec& spec = leg(stage);
      if (!shears(spec)) continue;
      for (std::size_t row = stage.start; row < stage.end; ++row) {
        const std::array<double, 3> s = principal(curve_.rows[row].stress);
        if (!(s[2] >= 0.0) || !(s[0] > 0.0)) continue;
        angles.push_back(degrees(std::asin((s[0] - s[2]) / (s[0] + s[2]))));
        if (!best) best.emplace();
        if (angles.size() == 1 || angles.back() > best->peak) {
          best->peak = angles.back();
          best->strain = strain(stage, row);
        }
        if (spec.kind == Kind::simple_shear)
          best->on_plane =
              std::max(best->on_plane, degrees(std::atan2(std::abs(column(Quantity::tau)[row]),
                                                          column(Quantity::sigma_a)[row])));
        else
          plane_strain = plane_strain && spec.kind == Kind::custom && smallest_strain(row) < 1e-12;
        last = row;
      }
      if (spec.kind != Kind::simple_shear && best) best->on_plane = nan;
    }
    if (!best) return best;
    best->after = after_largest(angles);
    best->end = angles.back();
    const LegSpec& spec = test_.path.legs[static_cast<std::size_t>(curve_.rows[last].leg)].spec();
    const std::array<double, 3> s = principal(curve_.rows[last].stress);
    if (spec.kind == Kind::triaxial)
      best->b = column(Quantity::q)[last] < 0.0 ? 1.0 : 0.0;
    else if (plane_strain)
      best->b = 0.5;  // associated flow at constant volume and no strain along: s_zz = 0
    else
      best->b = s[0] > s[2] ? (s[1] - s[2]) / (s[0] - s[2]) : nan;
    best->critical = critical_friction_angle(critical_ratio(), best->b);
    return best;
  }

  /// The smallest normal strain of a row: 0 where a direction is kept from straining.
  double smallest_strain(std::size_t row) const {
    const Sym<double, 6>& e = curve_.rows[row].strain;
    return std::min({std::abs(e[0]), std::abs(e[1]), std::abs(e[2])});
  }

  /// q/p of the law's critical state: M of clays, √3 μ_0 of grains as they come to rest.
  double critical_ratio() const {
    if (const int i = parameter_index(law_.parameters, "M"); i >= 0)
      return theta_[static_cast<std::size_t>(i)];
    if (const int i = parameter_index(law_.parameters, "mu_0"); i >= 0)
      return std::sqrt(3.0) * theta_[static_cast<std::size_t>(i)];
    return nan;
  }

  /// The stage driven again up to each goal in turn: the row in which it begins, and one for each
  /// goal, as far as it comes.
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
    const auto q = column(Quantity::q, ends), eps_a = column(Quantity::eps_a, ends);
    const double strained = eps_a[1] - eps_a[0];
    return Stiffness{(q[1] - q[0]) / strained, strained};
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
    for (const double gamma : at) {
      SecantShear secant{stage.number, gamma, nan};
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

  void branches(const StageRows& stage, double& largest, std::vector<CompressionBranch>& all) {
    using Way = CompressionBranch::Way;
    const auto& x = column(leg(stage).kind == Kind::oedometer ? Quantity::sigma_a : Quantity::p);
    const auto& p_c = column(Quantity::p_c);
    const bool knows_yield = state_index(law_.state, "p_c") >= 0;
    largest = std::max(largest, x[stage.start]);
    const auto way_of = [&](std::size_t row) {
      if (x[row] < x[row - 1]) return Way::unloading;
      const bool yields = knows_yield ? p_c[row] > p_c[row - 1] * (1.0 + 1e-9) : x[row] > largest;
      return yields ? Way::virgin : Way::reloading;
    };
    std::size_t from = stage.start;
    while (from + 1 < stage.end) {
      const Way way = way_of(from + 1);
      std::size_t to = from + 1;
      largest = std::max(largest, x[to]);
      while (to + 1 < stage.end && way_of(to + 1) == way) largest = std::max(largest, x[++to]);
      if (x[from] > 0.0 && x[to] > 0.0 && x[from] != x[to])
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
    b.C = (first.e - last.e) / ln_x * std::numbers::ln10;
    b.p_over_x = (last.ln_p - first.ln_p) / ln_x;
    b.K0 = column(Quantity::sigma_r)[to] / column(Quantity::sigma_a)[to];
    b.OCR = std::max(1.0, largest / x[to]);
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
  std::vector<StageRows> stages_;
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
