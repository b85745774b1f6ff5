#include "mpm/output/rest_pressure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace repose::mpm {
namespace {

/// A point as this file sees it: place, mass, height, and the two stresses in question.
struct Sample {
  double x, y, mass, height, solid;  ///< solid = mass/ρ_0 [m²]
  double pressure, vertical;
};

/// Cubic B-spline, ∫ over xi = 1, zero beyond |xi| = 2.
double spline(double xi) {
  const double a = std::abs(xi);
  if (a >= 2.0) return 0.0;
  const double far = 2.0 - a;
  const double near = std::max(0.0, 1.0 - a);
  return (far * far * far - 4.0 * near * near * near) / 6.0;
}

/// Samples in strips of width h, so that all within 2h in x are in five strips.
class Strips {
 public:
  Strips(const Simulation::Snapshot& points, const std::vector<double>& rho_0, double h,
         double width)
      : h_(h),
        width_(width),
        strip_(static_cast<std::size_t>(std::max(1.0, std::ceil(width / h)))) {
    for (std::size_t p = 0; p < points.x_m.size(); ++p) {
      const double m = points.mass[p];
      strip_[index(points.x_m[p])].push_back({points.x_m[p], points.y_m[p], m,
                                              std::sqrt(m / points.density[p]),
                                              m / rho_0[static_cast<std::size_t>(points.body[p])],
                                              points.pressure_Pa[p], -points.syy[p]});
    }
  }

  /// Calls f(sample, N(x − x_q)/h) for the samples within 2h in x, a wall's images included.
  template <class F>
  void near(double x, F&& f) const {
    const std::size_t middle = index(x);
    const std::size_t first = middle < 2 ? 0 : middle - 2;
    const std::size_t last = std::min(middle + 2, strip_.size() - 1);
    for (std::size_t i = first; i <= last; ++i)
      for (const Sample& q : strip_[i]) {
        const double weight =
            spline((x - q.x) / h_) + spline((x + q.x) / h_) + spline((x - 2.0 * width_ + q.x) / h_);
        if (weight > 0.0) f(q, weight / h_);
      }
  }

  template <class F>
  void each(F&& f) const {
    for (const auto& strip : strip_)
      for (const Sample& q : strip) f(q);
  }

 private:
  std::size_t index(double x) const {
    const double place = std::clamp(x / h_, 0.0, static_cast<double>(strip_.size() - 1));
    return static_cast<std::size_t>(place);
  }
  double h_, width_;
  std::vector<std::vector<Sample>> strip_;
};

/// Solid depth and weight of what lies above a place, per unit width.
struct Above {
  double depth = 0.0, mass = 0.0;
};

Above above(const Strips& strips, double x, double y) {
  Above sum;
  strips.near(x, [&](const Sample& q, double weight) {
    const double share = std::clamp((q.y - y) / q.height + 0.5, 0.0, 1.0);
    sum.depth += weight * share * q.solid;
    sum.mass += weight * share * q.mass;
  });
  return sum;
}

/// Values at (x, y) of the linear fits to pressure and vertical stress around it.
std::array<double, 2> local_mean(const Strips& strips, double x, double y, double h) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> b = Eigen::Matrix<double, 3, 2>::Zero();
  strips.near(x, [&](const Sample& q, double) {
    const double weight = q.mass * spline((x - q.x) / h) * spline((y - q.y) / h);
    if (weight == 0.0) return;
    const Eigen::Vector3d basis(1.0, (q.x - x) / h, (q.y - y) / h);
    A += weight * basis * basis.transpose();
    b += weight * basis * Eigen::RowVector2d(q.pressure, q.vertical);
  });
  // fewer than three neighbours, or all in a line: the fit of least norm, by A's eigenvectors
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(A);
  const Eigen::Vector3d& size = eigen.eigenvalues();
  Eigen::RowVector2d mean = Eigen::RowVector2d::Zero();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d along = eigen.eigenvectors().col(i);
    // what three sums of round-off leave of a zero
    if (size[i] > 10.0 * std::numeric_limits<double>::epsilon() * size[2])
      mean += along[0] / size[i] * (along.transpose() * b);
  }
  return {mean[0], mean[1]};
}

/// Sums of squares on their way to a Deviation.
struct Squares {
  Deviation sum;
  void add(double value, double mean, double overburden, double scale) {
    const auto square = [](double a) { return a * a; };
    sum.total += square((value - overburden) / scale);
    sum.smooth += square((mean - overburden) / scale);
    sum.noise += square((value - mean) / scale);
  }
  Deviation root(double n) const {
    return {std::sqrt(sum.total / n), std::sqrt(sum.smooth / n), std::sqrt(sum.noise / n)};
  }
};

struct Mean {
  double sum = 0.0, count = 0.0;
  void add(double value) {
    sum += value;
    count += 1.0;
  }
  double value() const { return sum / count; }
};

}  // namespace

RestPressure rest_pressure(const Simulation::Snapshot& points, const std::vector<double>& rho_0,
                           double h, double width, double g, double min_depth, double min_share) {
  const Strips strips(points, rho_0, h, width);
  double deepest = 0.0;
  RestPressure result;
  strips.each([&](const Sample& p) {
    const Above column = above(strips, p.x, -HUGE_VAL);
    deepest = std::max(deepest, column.depth);
  });
  struct Judged {
    const Sample* point;
    double overburden;
  };
  std::vector<Judged> judged;
  strips.each([&](const Sample& p) {
    if (above(strips, p.x, -HUGE_VAL).depth < min_share * deepest) return;
    const Above over = above(strips, p.x, p.y);
    if (over.depth < min_depth) return;
    judged.push_back({&p, g * over.mass});
    result.largest_overburden = std::max(result.largest_overburden, g * over.mass);
  });
  Squares floor_pressure, floor_vertical, pressure, vertical, pressure_of_largest,
      vertical_of_largest;
  Mean ratio, vertical_ratio, floor_ratio, floor_vertical_ratio;
  for (const auto& [p, overburden] : judged) {
    const auto [p_mean, v_mean] = local_mean(strips, p->x, p->y, h);
    pressure.add(p->pressure, p_mean, overburden, overburden);
    vertical.add(p->vertical, v_mean, overburden, overburden);
    pressure_of_largest.add(p->pressure, p_mean, overburden, result.largest_overburden);
    vertical_of_largest.add(p->vertical, v_mean, overburden, result.largest_overburden);
    ratio.add(p->pressure / overburden);
    vertical_ratio.add(p->vertical / overburden);
    if (p->y < 0.5 * h) {
      floor_pressure.add(p->pressure, p_mean, overburden, overburden);
      floor_vertical.add(p->vertical, v_mean, overburden, overburden);
      floor_ratio.add(p->pressure / overburden);
      floor_vertical_ratio.add(p->vertical / overburden);
    }
  }
  const auto n = static_cast<double>(judged.size());
  result.points = static_cast<std::int64_t>(judged.size());
  result.pressure = pressure.root(n);
  result.vertical = vertical.root(n);
  result.floor_pressure = floor_pressure.root(floor_ratio.count);
  result.floor_vertical = floor_vertical.root(floor_ratio.count);
  result.pressure_of_largest = pressure_of_largest.root(n);
  result.vertical_of_largest = vertical_of_largest.root(n);
  result.mean_ratio = ratio.value();
  result.mean_vertical_ratio = vertical_ratio.value();
  result.floor_ratio = floor_ratio.value();
  result.floor_vertical_ratio = floor_vertical_ratio.value();
  return result;
}

}  // namespace repose::mpm
