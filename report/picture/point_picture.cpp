#include "report/picture/point_picture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <fmt/core.h>

#include "models/cone.hpp"

namespace repose::report {
namespace {

using point::Quantity;

/// The rows of a stage, with the one that it begins in: start … end − 1.
struct StageRows {
  std::size_t start = 0, end = 0;
  std::size_t last_cycle = 0;  ///< first row of the last cycle, if there are several; else 0
  bool shears = false;
};

/// Reads columns in the units of the picture, and parameters by name.
class Source {
 public:
  Source(const input::PointTestFile& file, std::span<const double> theta, const point::Curve& curve)
      : law_(find_law(file.law)),
        theta_(theta),
        test_(file.test),
        curve_(curve) {
    const auto places = test_.path.places();
    int stage = 0, cycle = 0;
    for (std::size_t row = 0; row < curve.rows.size(); ++row) {
      const auto leg = static_cast<std::size_t>(curve.rows[row].leg);
      if (places[leg].stage != stage) {
        stages_.push_back({row == 0 ? 0 : row - 1, 0, 0,
                           kind(leg) == point::Kind::triaxial || kind(leg) == point::Kind::custom});
        cycle = places[leg].cycle;
      } else if (places[leg].cycle != cycle) {
        stages_.back().last_cycle = row;
        cycle = places[leg].cycle;
      }
      stage = places[leg].stage;
      stages_.back().end = row + 1;
    }
  }

  const std::vector<StageRows>& stages() const { return stages_; }
  std::vector<std::size_t> all_stages() const {
    std::vector<std::size_t> all(stages_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  }
  /// Those in which q is driven, after consolidation; all if there is none.
  std::vector<std::size_t> shear_stages() const {
    std::vector<std::size_t> sheared;
    for (const std::size_t k : all_stages())
      if (stages_[k].shears) sheared.push_back(k);
    return sheared.empty() ? all_stages() : sheared;
  }
  point::Kind last_kind() const { return kind(test_.path.legs.size() - 1); }

  std::vector<double> column(Quantity quantity, double factor = 1.0) const {
    std::vector<double> values;
    point::read_column(law_, theta_, test_, curve_, quantity, values);
    for (double& x : values) x *= factor;
    return values;
  }
  /// NaN if the law has no such parameter.
  double parameter(std::string_view name) const {
    const int i = point::parameter_index(law_.parameters, name);
    return i < 0 ? std::nan("") : theta_[static_cast<std::size_t>(i)];
  }
  /// The slope q/p at rest of a law that has an M, in the direction of shear of a row, and in
  /// triaxial compression (1) or extension (−1).
  double slope_at(std::size_t row) const {
    const double M = parameter("M");
    return M * cone::share(parameter("shape"), M, deviator(curve_.rows[row].stress));
  }
  double slope(double cos_3_theta) const {
    const double M = parameter("M");
    return cone::is_circle(parameter("shape")) ? M : M / cone::inverse_share(M, cos_3_theta);
  }
  /// "ε_{a} (logarithmic, %)"
  std::string strain_label(std::string_view symbol) const {
    return fmt::format("{} ({}, %)", symbol, point::name_of(test_.path.measure));
  }
  bool has_p_c() const { return point::variable_index(law_, "p_c") >= 0; }
  /// Does the law say an inertial number of its own?
  bool has_I() const { return point::variable_index(law_, "I") >= 0; }
  const LawInfo& law() const { return law_; }

 private:
  point::Kind kind(std::size_t leg) const { return test_.path.legs[leg].spec().kind; }

  std::vector<StageRows> stages_;
  const LawInfo& law_;
  std::span<const double> theta_;
  const point::PointTest& test_;
  const point::Curve& curve_;
};

constexpr double kPa = 1e-3, percent = 100.0;

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double x : values)
    if (std::isfinite(x)) most = std::max(most, std::abs(x));
  return most;
}

/// The slopes q/p of a surface above and below the axis of p.
struct Slopes {
  double upper, lower;
};

/// q = M√(p(p_c − p)), and below the axis where the curve goes into extension.
void yield_surface(Axes& axes, const std::string& name, Slopes M, double p_c, double shift,
                   bool extension, Style style) {
  std::vector<double> p, q;
  const int n = 120;
  for (int i = 0; i <= n; ++i) {
    const double angle = (extension ? 2.0 : 1.0) * std::numbers::pi * i / n;
    p.push_back(0.5 * p_c * (1.0 + std::cos(angle)) - shift);
    q.push_back(0.5 * p_c * (2 * i > n && extension ? M.lower : M.upper) * std::sin(angle));
  }
  axes.dashed(name, p, q, style);
}

/// Rows of two columns by stages, each in its own colour; in a stage of cycles the last of them
/// stands out from those before. The names stand in the first panel.
void stages(const Figure& figure, Axes& axes, const Source& source, const std::vector<double>& x,
            const std::vector<double>& y, const std::vector<std::size_t>& which) {
  const bool alone = which.size() == 1, named = figure.panels().front().get() == &axes;
  for (const std::size_t k : which) {
    const StageRows& stage = source.stages()[k];
    const auto line = [&](const std::string& name, std::size_t from, std::size_t to, Style style) {
      axes.line(named ? name : "", std::span(x).subspan(from, to - from),
                std::span(y).subspan(from, to - from), style);
    };
    if (stage.last_cycle > stage.start) {
      line("cycles", stage.start, stage.last_cycle, {Colour::sky, 1.0});
      line("last cycle", stage.last_cycle - 1, stage.end, {Colour::purple});
    } else {
      line(alone || which.size() > 6 ? "" : fmt::format("stage {}", k + 1), stage.start, stage.end,
           {alone ? Colour::blue : cycle_colour(k)});
    }
  }
}

void stages(const Figure& figure, Axes& axes, const Source& source, const std::vector<double>& x,
            const std::vector<double>& y) {
  stages(figure, axes, source, x, y, source.all_stages());
}

/// The slopes of the yield surface at a row: the law's own at rest, the upper one in the row's
/// direction of shear; where the material flows at a rate that raises them, both in the ratio of
/// the ellipse through the stress, q² = M²p(p_c − p).
Slopes slopes_of_surface(const Source& source, std::size_t row, Slopes at_rest) {
  if (!(source.has_I() && source.column(Quantity::I)[row] > 0.0)) return at_rest;
  const double p = source.column(Quantity::p)[row], p_c = source.column(Quantity::p_c)[row];
  const double through = std::abs(source.column(Quantity::q)[row]) / std::sqrt(p * (p_c - p));
  const double growth = through / source.slope_at(row);
  if (!std::isfinite(growth)) return at_rest;
  return {at_rest.upper * growth, at_rest.lower * growth};
}

void stress_path(Figure& figure, const Source& source, bool undrained) {
  Axes& axes = figure.add_axes();
  axes.title = "stress path";
  axes.x.label = undrained ? "p′, p (kPa)" : "p′ (kPa)";
  axes.y.label = "q (kPa)";
  const auto p = source.column(Quantity::p, kPa);
  const auto q = source.column(Quantity::q, kPa);
  const bool extension = !q.empty() && *std::min_element(q.begin(), q.end()) < -1e-6 * largest(p);
  if (std::isfinite(source.parameter("M"))) {
    const std::size_t last = p.size() - 1;
    const bool ends_below = !q.empty() && q.back() < 0.0;
    const Slopes M{ends_below || q.empty() ? source.slope(1.0) : source.slope_at(last),
                   source.slope(-1.0)};
    double reach = 1.05 * largest(p);
    if (source.has_p_c() && !p.empty()) {
      const double shift =
          std::isfinite(source.parameter("p_shift")) ? kPa * source.parameter("p_shift") : 0.0;
      const auto p_c = source.column(Quantity::p_c, kPa);
      yield_surface(axes, "yield, start", M, p_c.front(), shift, extension, {Colour::grey, 1.2});
      if (std::abs(p_c.back() - p_c.front()) > 1e-3 * p_c.front())
        yield_surface(axes, "yield, end", slopes_of_surface(source, last, M), p_c.back(), shift,
                      extension, {Colour::orange, 1.2});
      reach = std::max({reach, p_c.front(), p_c.back()});
    }
    const std::array<double, 2> line_p{0.0, reach}, line_q{0.0, M.upper * reach};
    axes.line("critical state", line_p, line_q, {Colour::black, 1.0});
    if (extension) {
      const std::array<double, 2> lower{0.0, -M.lower * reach};
      axes.line("", line_p, lower, {Colour::black, 1.0});
    }
  }
  if (undrained) {  // p = p′ + u
    std::vector<double> total = source.column(Quantity::u, kPa);
    for (std::size_t row = 0; row < total.size(); ++row) total[row] += p[row];
    const StageRows& sheared = source.stages()[source.shear_stages().front()];
    axes.dashed("total stress", std::span(total).subspan(sheared.start),
                std::span(q).subspan(sheared.start), {Colour::green, 1.2});
  }
  if (source.stages().size() == 1 && source.stages().front().last_cycle == 0)
    axes.line("effective stress", p, q, {Colour::blue});
  else
    stages(figure, axes, source, p, q);
}

void against_axial_strain(Figure& figure, const Source& source, bool undrained) {
  const auto eps_a = source.column(Quantity::eps_a, percent);
  const std::vector<std::size_t> sheared = source.shear_stages();
  Axes& stress = figure.add_axes();
  stress.title = "stress and strain";
  stress.x.label = source.strain_label("ε_{a}");
  stress.y.label = "q (kPa)";
  stages(figure, stress, source, eps_a, source.column(Quantity::q, kPa), sheared);
  Axes& volume = figure.add_axes();
  volume.x.label = source.strain_label("ε_{a}");
  if (undrained) {
    volume.title = "excess pore pressure";
    volume.y.label = "u (kPa)";
    stages(figure, volume, source, eps_a, source.column(Quantity::u, kPa), sheared);
  } else {
    volume.title = "volume (compression positive)";
    volume.y.label = source.strain_label("ε_{v}");
    stages(figure, volume, source, eps_a, source.column(Quantity::eps_v, percent), sheared);
  }
}

/// v over p on a logarithmic axis, with the law's lines where it has them.
void compression_plane(Figure& figure, const Source& source) {
  const auto v = source.column(Quantity::v);
  const auto p = source.column(Quantity::p, kPa);
  if (v.empty() || !std::isfinite(v.front()) || !std::isfinite(source.parameter("lambda"))) return;
  Axes& axes = figure.add_axes();
  axes.title = "compression plane";
  axes.x = {"p′ (kPa)", AxisScale::logarithmic};
  axes.y.label = "v";
  const double lambda = source.parameter("lambda"), p_ref = kPa * source.parameter("p_ref");
  const bool straight_in_v = source.law().option == "v-ln_p";
  double low = INFINITY, high = 0.0;
  for (const double x : p)
    if (x > 0.0) {
      low = std::min(low, 0.5 * x);
      high = std::max(high, 2.0 * x);
    }
  const auto line = [&](const char* name, const char* parameter, Colour colour) {
    const double at_ref = source.parameter(parameter);
    if (!std::isfinite(at_ref) || !std::isfinite(lambda) || !(high > low)) return;
    std::vector<double> line_p, line_v;
    for (int i = 0; i <= 60; ++i) {
      const double x = low * std::pow(high / low, i / 60.0);
      line_p.push_back(x);
      line_v.push_back(straight_in_v ? at_ref - lambda * std::log(x / p_ref)
                                     : at_ref * std::pow(p_ref / x, lambda));
    }
    axes.dashed(name, line_p, line_v, {colour, 1.2});
  };
  line("isotropic compression", "N", Colour::grey);
  line("critical state", "Gamma", Colour::black);
  stages(figure, axes, source, p, v);
}

/// One-dimensional compression as it is drawn in a laboratory: e (or ε_a) over log σ′_a, and K0.
void oedometer_panels(Figure& figure, const Source& source) {
  const auto sigma_a = source.column(Quantity::sigma_a, kPa);
  const auto v = source.column(Quantity::v);
  Axes& curve = figure.add_axes();
  curve.x = {"σ′_{a} (kPa)", AxisScale::logarithmic};
  if (!v.empty() && std::isfinite(v.front())) {
    curve.title = "compression curve";
    curve.y.label = "e";
    std::vector<double> e = v;
    for (double& x : e) x -= 1.0;
    stages(figure, curve, source, sigma_a, e);
  } else {
    curve.title = "compression curve (compression positive)";
    curve.y.label = source.strain_label("ε_{a}");
    stages(figure, curve, source, sigma_a, source.column(Quantity::eps_a, percent));
  }
  stress_path(figure, source, false);
  Axes& ratio = figure.add_axes();
  ratio.title = "horizontal stress";
  ratio.x = {"σ′_{a} (kPa)", AxisScale::logarithmic};
  ratio.y.label = "K_{0} = σ′_{r}/σ′_{a}";
  std::vector<double> K0 = source.column(Quantity::sigma_r, kPa);
  for (std::size_t row = 0; row < K0.size(); ++row) K0[row] /= sigma_a[row];
  stages(figure, ratio, source, sigma_a, K0);
}

/// v (or ε_v) over ln p′.
void isotropic_panels(Figure& figure, const Source& source) {
  compression_plane(figure, source);
  Axes& volume = figure.add_axes();
  volume.title = "volume (compression positive)";
  volume.x.label = "p′ (kPa)";
  volume.y.label = source.strain_label("ε_{v}");
  stages(figure, volume, source, source.column(Quantity::p, kPa),
         source.column(Quantity::eps_v, percent));
}

void shear_panels(Figure& figure, const Source& source) {
  const auto gamma = source.column(Quantity::gamma, percent);
  const auto tau = source.column(Quantity::tau, kPa);
  Axes& stress = figure.add_axes();
  stress.title = "shear stress";
  stress.x.label = "γ (%)";
  stress.y.label = "τ (kPa)";
  stages(figure, stress, source, gamma, tau);
  Axes& path = figure.add_axes();
  path.title = "stress path on the horizontal plane";
  path.x.label = "σ′_{yy} (kPa)";
  path.y.label = "τ (kPa)";
  stages(figure, path, source, source.column(Quantity::sigma_a, kPa), tau);
  const auto I = source.column(Quantity::I);
  if (std::isfinite(source.parameter("d"))) {
    Axes& axes = figure.add_axes();
    axes.title = "friction over inertial number";
    axes.x = {"I", AxisScale::logarithmic};
    axes.y.label = "μ = |s|/p′";
    std::vector<double> x, y, flow_x, flow_y;
    const auto mu = source.column(Quantity::mu);
    for (std::size_t i = 1; i < I.size(); ++i)  // row 0 is the state at rest
      if (I[i] > 0.0) {
        x.push_back(I[i]);
        y.push_back(mu[i]);
      }
    double mu_0 = source.parameter("mu_0"), mu_d = source.parameter("mu_d");
    const double I_0 = source.parameter("I_0");
    const double share = cone::shear_share(source.parameter("shape"), std::sqrt(3.0) * mu_0);
    mu_0 *= share;
    mu_d *= share;
    if (std::isfinite(mu_0) && !x.empty()) {
      const auto [low, high] = std::minmax_element(x.begin(), x.end());
      for (int i = 0; i <= 80; ++i) {
        const double at = 0.5 * *low * std::pow(4.0 * *high / *low, i / 80.0);
        flow_x.push_back(at);
        flow_y.push_back(mu_0 + (mu_d - mu_0) / (I_0 / at + 1.0));  // physics.md, MUI-2
      }
      axes.line("μ(I)", flow_x, flow_y, {Colour::black, 1.0});
    }
    axes.points("driven", x, y, {Colour::blue});
  } else {
    Axes& axes = figure.add_axes();
    axes.title = "volume (compression positive)";
    axes.x.label = "γ (%)";
    axes.y.label = source.strain_label("ε_{v}");
    stages(figure, axes, source, gamma, source.column(Quantity::eps_v, percent));
  }
}

}  // namespace

Figure point_picture(const input::PointTestFile& file, std::span<const double> theta,
                     const point::Curve& curve, std::string_view changes) {
  const std::string option(find_law(file.law).option);
  const std::string law = file.law.name + (option.empty() ? "" : " (" + option + ")");
  constexpr std::size_t longest = 60;  // characters of a title
  const bool in_title = !changes.empty() && file.name.size() + changes.size() <= longest;
  Figure figure(in_title ? fmt::format("{}, {}", file.name, changes) : file.name,
                fmt::format("{}{}, {} rows", law,
                            in_title || changes.empty() ? "" : fmt::format(", {}", changes),
                            curve.rows.size()));
  figure.columns = 2;
  const Source source(file, theta, curve);
  switch (source.last_kind()) {
    case point::Kind::simple_shear:
      shear_panels(figure, source);
      compression_plane(figure, source);
      break;
    case point::Kind::oedometer:
      oedometer_panels(figure, source);
      break;
    case point::Kind::isotropic:
      isotropic_panels(figure, source);
      break;
    case point::Kind::triaxial:
    case point::Kind::custom:
      stress_path(figure, source, file.test.path.undrained);
      against_axial_strain(figure, source, file.test.path.undrained);
      compression_plane(figure, source);
      break;
  }
  return figure;
}

}  // namespace repose::report
