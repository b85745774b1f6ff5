#include "calibration/misfit_cause.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "calibration/uncertainty.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::array factors{-1.0, 100.0, 1000.0, 0.01, 0.001};

/// Largest rms over range of one target's channels.
double left_over(const Problem& problem, std::size_t target, const VectorXd& z) {
  double worst = 0.0;
  const Target& t = problem.targets()[target];
  const Misfit m = problem.predict(target, z);
  for (std::size_t c = 0; c < t.channels.size(); ++c) {
    const VectorXd off = m.simulated.col(static_cast<Index>(c)) - t.channels[c].observed;
    const double range = t.channels[c].observed.maxCoeff() - t.channels[c].observed.minCoeff();
    const double size = range > 0.0 ? range : t.channels[c].observed.cwiseAbs().maxCoeff();
    worst = std::max(worst, std::sqrt(off.squaredNorm() / static_cast<double>(off.size())) /
                                std::max(size, 1e-300));
  }
  return std::isfinite(worst) ? worst : std::numeric_limits<double>::infinity();
}

/// The best that a short fit of one target alone leaves.
double best_left(const Problem& problem, std::size_t target, const VectorXd& z) {
  OptimiseOptions options;
  options.max_evaluations = 40;
  double best = left_over(problem, target, z);
  for (const VectorXd& from : {z, problem.space().start()}) {
    const Optimum o = levenberg_marquardt(problem, from, options);
    if (!o.failed) best = std::min(best, left_over(problem, target, o.z));
  }
  return best;
}

/// The target alone, its scales those of its own data: a factor must not make a misfit small by
/// making its unit large.
Problem alone(const Problem& problem, std::size_t target, const std::vector<std::size_t>& channels,
              double factor, std::shared_ptr<const Simulator> simulator) {
  std::vector<Target> targets = problem.targets();
  for (std::size_t k = 0; k < targets.size(); ++k) targets[k].held_out = k != target;
  Target& t = targets[target];
  if (simulator) t.simulator = std::move(simulator);
  for (Channel& c : t.channels) {
    c.noise.reset();
    c.row_noise.resize(0);
  }
  for (const std::size_t c : channels) t.channels[c].observed *= factor;
  Problem copy(problem.space(), std::move(targets));
  copy.interrupt_by([&problem] { return problem.interrupted(); });
  return copy;
}

std::string unit_of(const std::string& channel) {
  const auto at = channel.rfind('_');
  return at == std::string::npos ? "" : channel.substr(at);
}

}  // namespace

std::vector<MisfitCause> misfit_causes(const Problem& problem, const VectorXd& z) {
  std::vector<MisfitCause> causes;
  std::vector<bool> far(problem.targets().size(), false);
  for (const ChannelScore& s : score(problem, z))
    if (s.large && !problem.targets()[s.target].held_out) far[s.target] = true;
  for (std::size_t k = 0; k < far.size(); ++k) {
    if (!far[k] || problem.interrupted()) continue;
    const Target& t = problem.targets()[k];
    if (!t.simulator->has_derivatives()) continue;  // full simulations are too dear for guesses
    std::vector<std::vector<std::size_t>> sets;
    for (std::size_t c = 0; c < t.channels.size(); ++c) {
      sets.push_back({c});
      std::vector<std::size_t> alike;
      for (std::size_t d = 0; d < t.channels.size(); ++d)
        if (unit_of(t.channels[d].name) == unit_of(t.channels[c].name)) alike.push_back(d);
      if (alike.size() > 1 && alike.front() == c) sets.push_back(std::move(alike));
    }
    MisfitCause cause;
    cause.target = k;
    cause.before = best_left(alone(problem, k, {}, 1.0, {}), k, z);
    cause.after = cause.before;
    const auto consider = [&](const Problem& trial, const std::vector<std::size_t>& channels,
                              double factor) {
      const double left = best_left(trial, k, z);
      // of two that do as well the simpler one: it comes first
      if (!(left < 0.9 * cause.after)) return;
      cause.after = left;
      cause.channels = channels;
      cause.factor = factor;
    };
    for (const auto& channels : sets)
      for (const double factor : factors)
        consider(alone(problem, k, channels, factor, {}), channels, factor);
    for (const double factor : factors)
      if (auto other = t.simulator->with_abscissae_times(factor))
        consider(alone(problem, k, {}, 1.0, std::move(other)), {}, factor);
    if (cause.factor != 1.0 && cause.after < cause.before / 3.0 && cause.after < 0.1)
      causes.push_back(std::move(cause));
  }
  return causes;
}

std::string in_words(const Problem& problem, const MisfitCause& cause) {
  const Target& t = problem.targets()[cause.target];
  std::string what;
  for (const std::size_t c : cause.channels)
    what += (what.empty() ? "" : " and ") + t.channels[c].name;
  if (cause.channels.empty()) what = t.x_name;
  const bool one = cause.channels.size() < 2;
  std::array<char, 320> text{};
  const char* looks = one ? "looks" : "look";
  if (cause.factor < 0.0) {
    std::snprintf(text.data(), text.size(), "%s %s to have the other sign", what.c_str(),
                  one ? "seems" : "seem");
  } else {
    const bool small = cause.factor > 1.0;
    const double times = small ? cause.factor : 1.0 / cause.factor;
    const char* unit = times > 500.0 ? (small ? "kPa in a column of Pa" : "Pa in a column of kPa")
                                     : (small ? "a fraction in a column of per cent"
                                              : "per cent in a column of fractions");
    std::snprintf(text.data(), text.size(), "%s %s %.0f times too %s (%s?)", what.c_str(), looks,
                  times, small ? "small" : "large", unit);
  }
  std::array<char, 120> left{};
  std::snprintf(left.data(), left.size(),
                ": with that mended a fit of this experiment leaves %.2g %% of the range instead "
                "of %.2g %%",
                100.0 * cause.after, 100.0 * cause.before);
  return std::string(text.data()) + left.data();
}

}  // namespace repose::calibration
