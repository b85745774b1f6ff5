#include "calibration/target.hpp"

#include <cmath>

#include "models/parameter.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;

double range_of(const Eigen::VectorXd& values) {
  const double range = values.maxCoeff() - values.minCoeff();
  if (range > 0.0) return range;
  const double size = values.cwiseAbs().maxCoeff();
  return size > 0.0 ? size : 1.0;
}

/// A point of a polyline: between rows i and i + 1 at share t.
struct OnCurve {
  Index i = 0;
  double t = 0.0;
};

/// A stretch of rows over which x runs one way.
struct Branch {
  Index first = 0, last = 0;  ///< both included; branches share their turning points
  double way = 1.0;           ///< the sign of its change of x
  bool reached = true;        ///< false: the curve ended before, and its end stands for the branch
};

/// Cuts a series where x turns round by more than `least`: smaller steps back are scatter.
std::vector<Branch> branches_of(const Eigen::VectorXd& x, double least) {
  std::vector<Branch> list;
  const Index n = x.size();
  Index start = 0, far = 0;
  double way = 0.0;
  for (Index i = 1; i < n; ++i) {
    if (way == 0.0) {
      if (std::abs(x[i] - x[start]) <= least) continue;
      way = x[i] > x[start] ? 1.0 : -1.0;
      far = i;
    } else if (way * (x[i] - x[far]) >= 0.0) {
      far = i;
    } else if (way * (x[far] - x[i]) > least) {
      list.push_back({start, far, way, true});
      start = far;
      far = i;
      way = -way;
    }
  }
  list.push_back({start, n - 1, way == 0.0 ? 1.0 : way, true});
  return list;
}

/// The place on a branch with this x, on the first segment that spans it; beyond its ends on the
/// continuation of the last segment, or the nearer end itself.
OnCurve at_x(const Eigen::VectorXd& x, const Branch& on, double wanted, bool continues) {
  if (!on.reached) return {on.last - 1, 1.0};
  for (Index i = on.first; i < on.last; ++i) {
    const double a = x[i] - wanted, b = x[i + 1] - wanted;
    if (a == 0.0) return {i, 0.0};
    if ((a < 0.0) != (b < 0.0) || b == 0.0) return {i, a / (a - b)};
  }
  const bool before = std::abs(wanted - x[on.first]) < std::abs(wanted - x[on.last]);
  const Index i = before ? on.first : on.last - 1;
  const double dx = x[i + 1] - x[i];
  const double range = std::abs(x[on.last] - x[on.first]);
  if (!continues || !(std::abs(dx) > 1e-9 * range)) return {i, before ? 0.0 : 1.0};
  return {i, (wanted - x[i]) / dx};
}

/// The nearest place on the curve in scaled axes.
OnCurve nearest(const Eigen::VectorXd& x, const Eigen::VectorXd& y, double px, double py, double sx,
                double sy) {
  OnCurve best;
  double least = std::numeric_limits<double>::infinity();
  for (Index i = 0; i + 1 < x.size(); ++i) {
    const double ax = (x[i] - px) / sx, ay = (y[i] - py) / sy;
    const double dx = (x[i + 1] - x[i]) / sx, dy = (y[i + 1] - y[i]) / sy;
    const double length = dx * dx + dy * dy;
    const double t =
        length > 0.0 ? std::min(1.0, std::max(0.0, -(ax * dx + ay * dy) / length)) : 0.0;
    const double d = std::hypot(ax + t * dx, ay + t * dy);
    if (d < least) {
      least = d;
      best = {i, t};
    }
  }
  return best;
}

/// Linear combination of two rows.
template <class M>
auto blend(const M& m, const OnCurve& at) {
  return ((1.0 - at.t) * m.row(at.i) + at.t * m.row(at.i + 1)).eval();
}

struct Filler {
  const Target& target;
  const Response& response;
  Misfit& out;
  Index wanted;

  void rows(Index c) const {
    const Channel& channel = target.channels[static_cast<std::size_t>(c)];
    const Index n = target.rows(), done = std::min(n, response.y.rows());
    for (Index i = 0; i < n; ++i) {
      const double s = scale_of(channel, i);
      double y = channel.observed[0];
      if (i < done)
        y = response.y(i, c);
      else if (response.last.size() > 0)
        y = response.last[c];
      else if (done > 0)
        y = response.y(done - 1, c);
      out.simulated(i, c) = y;
      out.r[c * n + i] = (y - channel.observed[i]) / s;
      if (wanted > 0 && i < done)
        out.slope.row(c * n + i) = response.dy[static_cast<std::size_t>(c)].row(i) / s;
    }
  }

  /// For each row the branch of the simulated curve that it is compared with: branches count in
  /// the order of the path, from the first that runs the way of the data's first.
  std::vector<Branch> matched() const {
    const double least = 0.01 * range_of(target.x);
    const auto data = branches_of(target.x, least), curve = branches_of(response.x, least);
    const std::size_t offset = curve.size() > 1 && curve[0].way != data[0].way ? 1 : 0;
    std::vector<Branch> of_row(static_cast<std::size_t>(target.rows()));
    for (std::size_t b = data.size(); b-- > 0;) {  // a turning point belongs to the earlier one
      const bool there = b + offset < curve.size();
      Branch branch = there ? curve[b + offset] : curve.back();
      branch.reached = there;
      for (Index i = data[b].first; i <= data[b].last; ++i)
        of_row[static_cast<std::size_t>(i)] = branch;
    }
    return of_row;
  }

  void along(Index c) const {
    const Channel& channel = target.channels[static_cast<std::size_t>(c)];
    const Index n = target.rows();
    const Eigen::VectorXd y = response.y.col(c);
    const double x_range = range_of(target.x);
    const std::vector<Branch> branch =
        target.compare == Compare::distance ? std::vector<Branch>() : matched();
    for (Index i = 0; i < n; ++i) {
      const double s = scale_of(channel, i);
      // one range of x counts as much as one range of y
      const double sx = x_range * s / range_of(channel.observed);
      const double px = target.x[i], py = channel.observed[i];
      const bool distance = target.compare == Compare::distance;
      const Branch on = distance ? Branch() : branch[static_cast<std::size_t>(i)];
      const bool continues = target.continues && response.complete() && on.reached;
      const OnCurve at =
          distance ? nearest(response.x, y, px, py, sx, s) : at_x(response.x, on, px, continues);
      if (c == 0 && !distance && response.complete()) {
        const auto [low, high] = std::minmax(response.x[on.first], response.x[on.last]);
        if (!(px >= low - 1e-6 * x_range && px <= high + 1e-6 * x_range) || !on.reached)
          ++out.beyond;
      }
      const double cx = blend(response.x, at)[0], cy = blend(y, at)[0];
      out.simulated(i, c) = cy;
      const double tx = (response.x[at.i + 1] - response.x[at.i]) / sx,
                   ty = (y[at.i + 1] - y[at.i]) / s;
      const double ex = (cx - px) / sx, ey = (cy - py) / s;
      double nx = 0.0, ny = 1.0, r = ey;
      const Index row = c * n + i;
      if (distance) {
        // r = n·(curve − data), |n| = 1: as n is normal to the curve, moving along it changes
        // nothing to first order and dr = n·∂curve (at a corner n points to the data)
        const double d = std::hypot(ex, ey);
        const double side = tx * ey - ty * ex;
        r = side < 0.0 ? -d : d;
        const double length = std::hypot(tx, ty);
        if (d > 0.0 && r != 0.0) {
          nx = ex / r;
          ny = ey / r;
        } else if (length > 0.0) {
          nx = -ty / length;
          ny = tx / length;
        }
      } else if (tx != 0.0 && (continues || (at.t > 0.0 && at.t < 1.0))) {
        nx = -ty / tx;  // dy at fixed x: dy − (y′/x′) dx
      }
      out.r[row] = r;
      if (wanted > 0) {
        const Eigen::RowVectorXd dx = blend(response.dx, at);
        const Eigen::RowVectorXd dy = blend(response.dy[static_cast<std::size_t>(c)], at);
        out.slope.row(row) = nx / sx * dx + ny / s * dy;
      }
    }
  }
};

}  // namespace

std::vector<double> turning_points(const Eigen::VectorXd& x) {
  std::vector<double> points;
  if (x.size() < 2) return points;
  for (const Branch& branch : branches_of(x, 0.01 * range_of(x))) points.push_back(x[branch.last]);
  return points;
}

double scale_of(const Channel& channel) {
  return channel.noise ? *channel.noise : range_of(channel.observed);
}

double scale_of(const Channel& channel, Index row) {
  return channel.row_noise.size() > 0 ? channel.row_noise[row] : scale_of(channel);
}

void declare_noise(Channel& channel, double absolute, double relative) {
  channel.row_noise = (absolute * absolute + (relative * channel.observed.array()).square()).sqrt();
  if (!(channel.row_noise.minCoeff() > 0.0))
    throw InputError("noise", "the noise of " + channel.name +
                                  " is a share of its value, which is 0 in a row: give an absolute "
                                  "part as well");
  channel.noise =
      std::sqrt(channel.row_noise.squaredNorm() / static_cast<double>(channel.row_noise.size()));
}

void misfit(const Target& target, const Response& response, Misfit& out) {
  const Index n = target.rows();
  const auto channels = static_cast<Index>(target.channels.size());
  const Index wanted = response.dy.empty() ? 0 : response.dy[0].cols();
  out.r.resize(n * channels);
  out.simulated.resize(n, channels);
  out.slope = Eigen::MatrixXd::Zero(n * channels, wanted);
  out.beyond = 0;
  const Filler fill{target, response, out, wanted};
  for (Index c = 0; c < channels; ++c) {
    if (target.compare == Compare::rows || response.x.size() < 2)
      fill.rows(c);
    else
      fill.along(c);
  }
  out.finite = out.r.allFinite() && out.r.cwiseAbs().maxCoeff() < 1e100 && out.slope.allFinite();
}

}  // namespace repose::calibration
