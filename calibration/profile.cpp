// The likelihood along one value, and the interval to quote.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calibration/uncertainty.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Walks from the optimum along one parameter's value; each point is a refit.
class Walk {
 public:
  Walk(const Problem& problem, const Uncertainty& at, const VectorXd& z, int parameter)
      : problem_(problem),
        at_(at),
        i_(parameter),
        reach_(problem.space().reach(static_cast<std::size_t>(parameter))) {
    Evaluation e;
    problem.evaluate(z, false, e);
    best_ = 2.0 * e.objective();
    const double error = at.released_error[i_];
    known_ = std::isfinite(error) && error > 0.0 && at.naive[i_] > 0.0;
    // the misfit's own scale, so that the profile's curvature at the optimum is the covariance's
    factor_ = known_ ? error * error / at.naive[i_] : std::max(at.noise.mean_variance(), 1e-300);
    const FreeParameter& p = space()[static_cast<std::size_t>(i_)];
    log_ = p.scale == Scale::log && reach_[0] > 0.0;
    bounded_ = p.of < 0;
    options_.fixed.assign(static_cast<std::size_t>(problem.parameters()), false);
    options_.fixed[static_cast<std::size_t>(i_)] = true;
    options_.max_evaluations = 60;
  }

  double coordinate(double value) const { return log_ ? std::log(value) : value; }
  double value(double coordinate) const { return log_ ? std::exp(coordinate) : coordinate; }
  double bound(double sign) const { return coordinate(sign < 0.0 ? reach_[0] : reach_[1]); }
  /// Length of a step that makes a good point: a part of the linear interval.
  double stride(double sign, int points) const {
    const auto k = static_cast<std::size_t>(i_);
    const double whole = std::abs(bound(sign) - coordinate(at_.values[i_]));
    double linear =
        std::abs(coordinate(at_.interval[k][sign < 0.0 ? 0 : 1]) - coordinate(at_.values[i_]));
    if (!known_ || !(linear > 0.0)) linear = whole;
    return std::max(1.25 * linear / points, 1e-9 * (bound(1.0) - bound(-1.0)));
  }

  /// Fits all others again; `from` are the values to begin at and become those found. Nothing if
  /// the value is out of reach.
  std::optional<double> excess(double coordinate, VectorXd& from) {
    const double held = std::clamp(value(coordinate), reach_[0], reach_[1]);
    const auto space = problem_.space().held(static_cast<std::size_t>(i_), held);
    if (!space) return {};
    const Problem refit = problem_.with_space(*space);
    from[i_] = held;
    const Optimum o = levenberg_marquardt(refit, clipped(space->coordinates(from)), options_);
    problem_.account(refit);
    from = space->values(o.z);
    const double rise = (2.0 * o.objective - best_) / factor_;
    better = better || rise < -0.01;
    double below = infinity, above = infinity;
    if (bounded_ && known_) {
      const FreeParameter& p = this->space()[static_cast<std::size_t>(i_)];
      const double per = at_.released_error[i_] / (log_ ? at_.values[i_] : 1.0);
      below = std::abs(coordinate - this->coordinate(std::max(p.lower, reach_[0]))) / per;
      above = std::abs(this->coordinate(std::min(p.upper, reach_[1])) - coordinate) / per;
    }
    const double limit = std::max(critical_excess(at_.freedoms[i_], below, above), 1e-12);
    return std::max(0.0, rise) * at_limit / limit;
  }

  bool better = false;
  static constexpr double at_limit = 3.841458821;  ///< 1.959963985²

 private:
  const ParameterSpace& space() const { return problem_.space(); }
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  const Problem& problem_;
  const Uncertainty& at_;
  Index i_;
  std::array<double, 2> reach_;
  double best_ = 0.0, factor_ = 1.0;
  bool known_ = false, log_ = false, bounded_ = true;
  OptimiseOptions options_;
};

std::string said(const char* text, double x) {
  std::array<char, 160> out{};
  std::snprintf(out.data(), out.size(), text, x);
  return out.data();
}

}  // namespace

double profile_excess(const Problem& problem, const Uncertainty& at, const VectorXd& z,
                      int parameter, double value) {
  Walk walk(problem, at, z, parameter);
  const auto [lower, upper] = problem.space().reach(static_cast<std::size_t>(parameter));
  VectorXd from = at.values;
  const auto found = value >= lower && value <= upper ? walk.excess(walk.coordinate(value), from)
                                                      : std::optional<double>();
  return found.value_or(std::numeric_limits<double>::infinity());
}

Profile profile(const Problem& problem, const Uncertainty& at, const VectorXd& z, int parameter,
                int points_per_side) {
  Profile p;
  p.parameter = parameter;
  Walk walk(problem, at, z, parameter);
  const double middle = walk.coordinate(at.values[parameter]);
  const auto side = [&](double sign, double& end, bool& open) {
    std::vector<std::pair<double, double>> points;
    VectorXd from = at.values;
    double last = middle, root_last = 0.0, stride = walk.stride(sign, points_per_side);
    const double bound = walk.bound(sign);
    open = true;
    for (int k = 0; k < 4 * points_per_side && !problem.interrupted(); ++k) {
      double next = last + sign * stride;
      if (sign * (next - bound) > 0.0) next = bound;
      if (next == last) break;
      VectorXd there = from;
      const auto excess = walk.excess(next, there);
      if (!excess) break;
      double root = std::sqrt(*excess / Walk::at_limit);
      points.emplace_back(walk.value(next), *excess);
      if (root >= 1.0) {
        // between a point inside and one outside: √excess is nearly straight
        double inside = last, root_inside = root_last, outside = next;
        for (int refine = 0; refine < 6; ++refine) {
          const double share = (1.0 - root_inside) / (root - root_inside);
          const double guess = inside + share * (outside - inside);
          end = walk.value(guess);
          if (std::abs(share - 0.5) > 0.4999 || root - root_inside < 1e-3) break;
          VectorXd again = from;
          const auto found = walk.excess(guess, again);
          if (!found) break;
          points.emplace_back(end, *found);
          const double here = std::sqrt(*found / Walk::at_limit);
          if (std::abs(here - 1.0) < 1e-3) break;
          if (here < 1.0) {
            inside = guess;
            root_inside = here;
          } else {
            outside = guess;
            root = here;
          }
        }
        open = false;
        break;
      }
      if (root - root_last < 0.3 / points_per_side) stride *= 2.0;
      root_last = root;
      last = next;
      from = there;
      end = walk.value(next);
      if (next == bound) break;
    }
    std::sort(points.begin(), points.end());
    return points;
  };
  p.lower = p.upper = at.values[parameter];
  const auto below = side(-1.0, p.lower, p.lower_open);
  const auto above = side(1.0, p.upper, p.upper_open);
  for (const auto& [value, excess] : below) {
    p.value.push_back(value);
    p.excess.push_back(excess);
  }
  p.value.push_back(at.values[parameter]);
  p.excess.push_back(0.0);
  for (const auto& [value, excess] : above) {
    p.value.push_back(value);
    p.excess.push_back(excess);
  }
  p.better = walk.better;
  return p;
}

std::vector<Recommendation> recommend(const Problem& problem, const Uncertainty& at,
                                      const std::vector<Profile>& profiles) {
  std::vector<Recommendation> list;
  for (std::size_t i = 0; i < problem.space().size(); ++i) {
    const auto k = static_cast<Index>(i);
    const auto reach = problem.space().reach(i);
    Recommendation r;
    const auto found = std::find_if(profiles.begin(), profiles.end(), [&](const Profile& p) {
      return p.parameter == static_cast<int>(i);
    });
    const bool stopped = at.at_bound[i] != 0;
    if (found != profiles.end() && !found->better) {
      r.kind = "profile";
      r.interval = {found->lower, found->upper};
      r.lower_is_bound = found->lower_open;
      r.upper_is_bound = found->upper_open;
      if (r.lower_is_bound && r.upper_is_bound) {
        r.kind = "bounds";
        r.reason = "the data exclude no value within the bounds";
      } else if (stopped) {
        r.reason =
            "one-sided, from the profile: the best value is at a bound, which is no "
            "measurement";
      } else {
        const double linear = at.interval[i][1] - at.interval[i][0];
        const double ratio = (r.interval[1] - r.interval[0]) / linear;
        r.reason = std::abs(ratio - 1.0) < 0.05
                       ? "profile: it keeps to the bounds and the curve of the misfit; the linear "
                         "interval agrees to 5 %"
                       : said(
                             "profile: it keeps to the bounds and the curve of the misfit, which "
                             "make it %.2g times as wide as the linear one",
                             ratio);
      }
    } else {
      r.kind = "linear";
      r.interval = at.interval[i];
      r.lower_is_bound = !(r.interval[0] > reach[0]);
      r.upper_is_bound = !(r.interval[1] < reach[1]);
      if (!std::isfinite(at.released_error[k])) {
        r.kind = "bounds";
        r.reason = "the data do not determine it";
      } else if (found != profiles.end()) {
        r.reason =
            "linear: the profile found a better fit than this one, so that both are doubtful";
      } else {
        r.reason = stopped ? "linear and one-sided, as there is no profile: the best value is at a "
                             "bound, which is no measurement"
                           : "linear: there is no profile";
      }
    }
    list.push_back(std::move(r));
  }
  return list;
}

}  // namespace repose::calibration
