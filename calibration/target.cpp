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

/// The place on the curve with this x, on the first segment that spans it; the nearer end if none
/// does.
OnCurve at_x(const Eigen::VectorXd& x, double wanted) {
  for (Index i = 0; i + 1 < x.size(); ++i) {
    const double a = x[i] - wanted, b = x[i + 1] - wanted;
    if (a == 0.0) return {i, 0.0};
    if ((a < 0.0) != (b < 0.0) || b == 0.0) return {i, a / (a - b)};
  }
  const bool first = std::abs(x[0] - wanted) < std::abs(x[x.size() - 1] - wanted);
  return first ? OnCurve{0, 0.0} : OnCurve{x.size() - 2, 1.0};
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

  void along(Index c) const {
    const Channel& channel = target.channels[static_cast<std::size_t>(c)];
    const Index n = target.rows();
    const Eigen::VectorXd y = response.y.col(c);
    for (Index i = 0; i < n; ++i) {
      const double s = scale_of(channel, i);
      // one range of x counts as much as one range of y
      const double sx = range_of(target.x) * s / range_of(channel.observed);
      const double px = target.x[i], py = channel.observed[i];
      const bool distance = target.compare == Compare::distance;
      const OnCurve at = distance ? nearest(response.x, y, px, py, sx, s) : at_x(response.x, px);
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
      } else if (tx != 0.0 && at.t > 0.0 && at.t < 1.0) {
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
