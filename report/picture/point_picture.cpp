#include "report/picture/point_picture.hpp"

#include <cmath>
#include <numbers>

#include <fmt/core.h>

namespace repose::report {
namespace {

using point::Quantity;

/// Reads columns in the units of the picture, and parameters by name.
class Source {
 public:
  Source(const input::PointTestFile& file, std::span<const double> theta, const point::Curve& curve)
      : law_(find_law(file.law)),
        theta_(theta),
        test_(file.test),
        curve_(curve) {}

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
  /// "ε_{a} (logarithmic, %)"
  std::string strain_label(std::string_view symbol) const {
    return fmt::format("{} ({}, %)", symbol, point::name_of(test_.path.measure));
  }
  bool has_p_c() const { return point::state_index(law_.state, "p_c") >= 0; }
  const LawInfo& law() const { return law_; }

 private:
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

/// q = M√(p(p_c − p)), mirrored to −q where the curve goes into extension.
void yield_surface(Axes& axes, const std::string& name, double M, double p_c, double shift,
                   bool extension, Style style) {
  std::vector<double> p, q;
  const int n = 120;
  for (int i = 0; i <= n; ++i) {
    const double angle = (extension ? 2.0 : 1.0) * std::numbers::pi * i / n;
    p.push_back(0.5 * p_c * (1.0 + std::cos(angle)) - shift);
    q.push_back(0.5 * p_c * M * std::sin(angle));
  }
  axes.dashed(name, p, q, style);
}

void stress_path(Figure& figure, const Source& source) {
  Axes& axes = figure.add_axes();
  axes.title = "stress path";
  axes.x.label = "p (kPa)";
  axes.y.label = "q (kPa)";
  const auto p = source.column(Quantity::p, kPa);
  const auto q = source.column(Quantity::q, kPa);
  const bool extension = !q.empty() && *std::min_element(q.begin(), q.end()) < -1e-6 * largest(p);
  const double M = source.parameter("M");
  if (std::isfinite(M)) {
    double reach = 1.05 * largest(p);
    if (source.has_p_c() && !p.empty()) {
      const double shift =
          std::isfinite(source.parameter("p_shift")) ? kPa * source.parameter("p_shift") : 0.0;
      const auto p_c = source.column(Quantity::p_c, kPa);
      yield_surface(axes, "yield, start", M, p_c.front(), shift, extension, {Colour::grey, 1.2});
      if (std::abs(p_c.back() - p_c.front()) > 1e-3 * p_c.front())
        yield_surface(axes, "yield, end", M, p_c.back(), shift, extension, {Colour::orange, 1.2});
      reach = std::max({reach, p_c.front(), p_c.back()});
    }
    const std::array<double, 2> line_p{0.0, reach}, line_q{0.0, M * reach};
    axes.line("critical state", line_p, line_q, {Colour::black, 1.0});
    if (extension) {
      const std::array<double, 2> lower{0.0, -M * reach};
      axes.line("", line_p, lower, {Colour::black, 1.0});
    }
  }
  axes.line("path", p, q, {Colour::blue});
}

void against_axial_strain(Figure& figure, const Source& source, bool undrained) {
  const auto eps_a = source.column(Quantity::eps_a, percent);
  Axes& stress = figure.add_axes();
  stress.title = "stress and strain";
  stress.x.label = source.strain_label("ε_{a}");
  stress.y.label = "q (kPa)";
  stress.line("", eps_a, source.column(Quantity::q, kPa), {Colour::blue});
  Axes& volume = figure.add_axes();
  volume.x.label = source.strain_label("ε_{a}");
  if (undrained) {
    volume.title = "excess pore pressure";
    volume.y.label = "u (kPa)";
    volume.line("", eps_a, source.column(Quantity::u, kPa), {Colour::vermillion});
  } else {
    volume.title = "volume (compression positive)";
    volume.y.label = source.strain_label("ε_{v}");
    volume.line("", eps_a, source.column(Quantity::eps_v, percent), {Colour::vermillion});
  }
}

/// v over p on a logarithmic axis, with the law's lines where it has them.
void compression_plane(Figure& figure, const Source& source) {
  const auto v = source.column(Quantity::v);
  const auto p = source.column(Quantity::p, kPa);
  if (v.empty() || !std::isfinite(v.front()) || !std::isfinite(source.parameter("lambda"))) return;
  Axes& axes = figure.add_axes();
  axes.title = "compression plane";
  axes.x = {"p (kPa)", AxisScale::logarithmic};
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
  axes.line("path", p, v, {Colour::blue});
}

void shear_panels(Figure& figure, const Source& source) {
  const auto gamma = source.column(Quantity::gamma, percent);
  const auto tau = source.column(Quantity::tau, kPa);
  Axes& stress = figure.add_axes();
  stress.title = "shear stress";
  stress.x.label = "γ (%)";
  stress.y.label = "τ (kPa)";
  stress.line("", gamma, tau, {Colour::blue});
  Axes& path = figure.add_axes();
  path.title = "stress path";
  path.x.label = "p (kPa)";
  path.y.label = "τ (kPa)";
  path.line("", source.column(Quantity::p, kPa), tau, {Colour::blue});
  const auto I = source.column(Quantity::I);
  if (std::isfinite(source.parameter("d"))) {
    Axes& axes = figure.add_axes();
    axes.title = "friction over inertial number";
    axes.x = {"I", AxisScale::logarithmic};
    axes.y.label = "μ = τ/p";
    std::vector<double> x, y, flow_x, flow_y;
    const auto mu = source.column(Quantity::mu);
    for (std::size_t i = 1; i < I.size(); ++i)  // row 0 is the state at rest
      if (I[i] > 0.0) {
        x.push_back(I[i]);
        y.push_back(mu[i]);
      }
    const double mu_0 = source.parameter("mu_0"), mu_d = source.parameter("mu_d"),
                 I_0 = source.parameter("I_0");
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
    axes.line("", gamma, source.column(Quantity::eps_v, percent), {Colour::vermillion});
  }
}

}  // namespace

Figure point_picture(const input::PointTestFile& file, std::span<const double> theta,
                     const point::Curve& curve) {
  Figure figure(file.name, fmt::format("{} ({}), {} rows", file.law.name, find_law(file.law).option,
                                       curve.rows.size()));
  if (find_law(file.law).option.empty())
    figure.subtitle = fmt::format("{}, {} rows", file.law.name, curve.rows.size());
  figure.columns = 2;
  const Source source(file, theta, curve);
  if (file.test.path.frame == point::Frame::shear) {
    shear_panels(figure, source);
  } else {
    stress_path(figure, source);
    against_axial_strain(figure, source, file.test.path.undrained);
  }
  compression_plane(figure, source);
  return figure;
}

}  // namespace repose::report
