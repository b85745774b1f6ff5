#include "calibration/path_derivatives.hpp"

#include "pointdriver/integrate/library_drives.hpp"
#include "pointdriver/integrate/outside_driver.hpp"
#include "pointdriver/integrate/plain_rows.hpp"
#include "pointdriver/integrate/start.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;

constexpr int width = point::gradient_width;
using D = point::Gradient;

/// Drives a law. Numbers, here and below, are all that a path starts from: completed parameters,
/// stress and state, density.
struct Drive {
  virtual ~Drive() = default;
  virtual std::size_t parameters() const = 0;
  /// Throws InputError.
  virtual std::vector<double> start(std::span<const double> theta,
                                    const point::PointTest& test) const = 0;
  virtual point::Outcome drive(std::span<const D> numbers, std::span<const double> plain,
                               const point::PointTest& test, point::BasicCurve<D>& curve,
                               point::Readout<D>& readout) const = 0;
};

/// A law of the library, by its type.
template <class L>
struct LibraryDrive final : Drive {
  std::size_t parameters() const override { return L::parameters.size(); }

  std::vector<double> start(std::span<const double> theta,
                            const point::PointTest& test) const override {
    std::vector<double> numbers = point::completed<L>(theta);
    const auto start = point::plain_start<L>(std::span<const double>(numbers), test);
    numbers.insert(numbers.end(), start.stress_and_state.begin(), start.stress_and_state.end());
    numbers.push_back(start.density);
    return numbers;
  }

  point::Outcome drive(std::span<const D> numbers, std::span<const double> plain,
                       const point::PointTest& test, point::BasicCurve<D>& curve,
                       point::Readout<D>& readout) const override {
    constexpr std::size_t n = L::parameters.size();
    point::ElementStart<L, D> start;
    start.plain = L::template Params<double>::from(plain.first(n));
    start.parameters = L::template Params<D>::from(numbers.first(n));
    for (std::size_t i = 0; i < start.stress_and_state.size(); ++i)
      start.stress_and_state[i] = numbers[n + i];
    start.density = numbers.back();
    const point::Outcome outcome = point::drive_path<L, D>(start, test.path, test.settings, curve);
    readout = point::make_readout(start, test.path.frame);
    return outcome;
  }
};

/// The same of a law from outside, through plain numbers.
struct OutsideDrive final : Drive {
  explicit OutsideDrive(const LawInfo& info) : law(info), driver(point::outside_driver(info)) {}
  const LawInfo& law;
  const point::OutsideDriver& driver;

  std::size_t parameters() const override { return law.parameters.size(); }
  std::vector<double> start(std::span<const double> theta,
                            const point::PointTest& test) const override {
    return driver.start(theta, test);
  }
  point::Outcome drive(std::span<const D> numbers, std::span<const double> plain,
                       const point::PointTest& test, point::BasicCurve<D>& curve,
                       point::Readout<D>& readout) const override {
    static_assert(width == point::OutsideDriver::slope_width);
    std::vector<double> slopes;
    for (int k = 0; k < width; ++k)
      for (const D& x : numbers) slopes.push_back(x.v[k]);
    point::Curve values;
    std::vector<point::Curve> slope_curves;
    driver.drive(plain, slopes, test, values, slope_curves);
    join(values, slope_curves, curve);
    readout.frame = test.path.frame;
    if (const int i = point::parameter_index(law.parameters, "rho_p"); i >= 0)
      readout.rho_p = numbers[static_cast<std::size_t>(i)];
    if (const int i = point::parameter_index(law.parameters, "d"); i >= 0)
      readout.d = numbers[static_cast<std::size_t>(i)];
    point::find_variables(law.state, law.derived, readout);
    const std::size_t n = parameters();
    readout.sigma_r_start = D(-0.5) * (numbers[n] + numbers[n + 2]);
    return curve.outcome;
  }
};

bool start_numbers(const Drive& law, const InitialConditions& fixed, std::span<const double> inputs,
                   std::vector<double>& out) {
  try {
    const PointInputs in = split_inputs(law.parameters(), fixed, inputs);
    point::PointTest test;
    test.initial = in.initial;
    out = law.start(in.theta, test);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// d(start numbers)/d(input i): central, or one-sided of second order where one side is not
/// admissible (ocr = 1).
bool start_slope(const Drive& law, const InitialConditions& fixed, std::span<const double> inputs,
                 int i, const std::vector<double>& here, std::vector<double>& slope) {
  std::vector<double> moved(inputs.begin(), inputs.end()), a, b;
  double& x = moved[static_cast<std::size_t>(i)];
  const double x0 = x;
  const double h = 1e-5 * std::max(std::abs(x0), 1e-6);
  slope.assign(here.size(), 0.0);
  const auto at = [&](double shift, std::vector<double>& out) {
    x = x0 + shift;
    return start_numbers(law, fixed, moved, out);
  };
  const bool above = at(h, a), below = at(-h, b);
  if (above && below) {
    for (std::size_t k = 0; k < here.size(); ++k) slope[k] = (a[k] - b[k]) / (2.0 * h);
    return true;
  }
  const double s = above ? h : -h;
  if (!(above || below) || !at(s, a) || !at(2.0 * s, b)) return false;
  for (std::size_t k = 0; k < here.size(); ++k)
    slope[k] = (-3.0 * here[k] + 4.0 * a[k] - b[k]) / (2.0 * s);
  return true;
}

point::Outcome drive(const Drive& law, const InitialConditions& fixed,
                     std::span<const double> inputs, std::span<const int> wanted,
                     const point::PointTest& test, std::span<const point::Quantity> quantities,
                     std::vector<Column>& columns, std::vector<int>& legs) {
  const std::size_t n_theta = law.parameters();
  point::Outcome outcome;
  outcome.status = point::Status::bad_initial;
  std::vector<double> here, slope;
  if (!start_numbers(law, fixed, inputs, here)) return outcome;
  std::vector<D> numbers;
  for (const double x : here) numbers.emplace_back(x);
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    if (!start_slope(law, fixed, inputs, wanted[k], here, slope)) return outcome;
    if (static_cast<std::size_t>(wanted[k]) < n_theta)
      slope[static_cast<std::size_t>(wanted[k])] = 1.0;
    for (std::size_t i = 0; i < here.size(); ++i)
      numbers[i].v[static_cast<Index>(k)] = std::isfinite(slope[i]) ? slope[i] : 0.0;
  }
  if (!point::suits(test.path, std::span<const double>(here).subspan(n_theta, 6))) return outcome;
  thread_local point::BasicCurve<D> curve;
  point::Readout<D> readout;
  outcome = law.drive(numbers, here, test, curve, readout);
  readout.measure = test.path.measure;
  point::set_pore_pressure_datum(curve.rows, test.path.first_undrained, readout);
  const auto rows = static_cast<Index>(curve.rows.size());
  legs.clear();
  for (const auto& row : curve.rows) legs.push_back(row.leg);
  for (std::size_t c = 0; c < quantities.size(); ++c) {
    columns[c].value.resize(rows);
    columns[c].slope.resize(rows, static_cast<Index>(wanted.size()));
    for (Index i = 0; i < rows; ++i) {
      const D x = point::read(quantities[c], curve.rows[static_cast<std::size_t>(i)], readout);
      columns[c].value[i] = x.a;
      columns[c].slope.row(i) = x.v.head(static_cast<Index>(wanted.size())).transpose();
    }
  }
  return outcome;
}

}  // namespace

PointInputs split_inputs(std::size_t parameters, const InitialConditions& fixed,
                         std::span<const double> inputs) {
  PointInputs in;
  in.theta.assign(inputs.begin(), inputs.begin() + static_cast<std::ptrdiff_t>(parameters));
  in.initial = fixed;
  const auto given = [&](InitialInput i, std::optional<double>& to) {
    const double x = inputs[parameters + static_cast<std::size_t>(i)];
    if (!std::isnan(x)) to = x;
  };
  given(input_p, in.initial.p);
  given(input_ocr, in.initial.ocr);
  given(input_v, in.initial.v);
  given(input_K0, in.initial.K0);
  const double p_c0 = inputs[parameters + input_p_c0];
  if (!std::isnan(p_c0) && in.initial.p) in.initial.ocr = p_c0 / *in.initial.p;
  return in;
}

point::Outcome simulate_with_derivatives(const LawInfo& law, const InitialConditions& fixed,
                                         std::span<const double> inputs,
                                         std::span<const int> wanted, const point::PointTest& test,
                                         std::span<const point::Quantity> quantities,
                                         std::vector<Column>& columns, std::vector<int>& legs) {
  columns.resize(quantities.size());
  for (Column& column : columns) {
    column.value.resize(0);
    column.slope.resize(0, 0);
  }
  legs.clear();
  const auto in_passes = [&](const Drive& driven) {
    std::vector<Column> part;
    point::Outcome outcome;
    // the steps are chosen by values alone, so every pass takes the same ones
    for (std::size_t first = 0; first == 0 || first < wanted.size(); first += width) {
      const std::size_t count = std::min<std::size_t>(width, wanted.size() - first);
      part.resize(quantities.size());
      outcome =
          drive(driven, fixed, inputs, wanted.subspan(first, count), test, quantities, part, legs);
      if (outcome.status == point::Status::bad_initial) return outcome;
      for (std::size_t c = 0; c < quantities.size(); ++c) {
        Eigen::MatrixXd joined(part[c].slope.rows(), static_cast<Index>(first + count));
        if (first > 0) joined.leftCols(static_cast<Index>(first)) = columns[c].slope;
        joined.rightCols(static_cast<Index>(count)) = part[c].slope;
        columns[c].value = part[c].value;
        columns[c].slope = std::move(joined);
      }
    }
    return outcome;
  };
  return visit_law(
      law, [&]<class L>(L) { return in_passes(LibraryDrive<L>{}); },
      [&] { return in_passes(OutsideDrive(law)); });
}

}  // namespace repose::calibration
