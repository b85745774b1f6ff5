#include "calibration/predictive.hpp"

#include <tbb/parallel_for.h>

#include "calibration/convergence.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The fitted blocks whose errors a channel has: its own, or those of its name.
std::vector<std::size_t> blocks_for(const Problem& problem, std::size_t target,
                                    std::size_t channel) {
  std::vector<std::size_t> own, alike;
  for (std::size_t k = 0; k < problem.blocks().size(); ++k) {
    const Block& b = problem.blocks()[k];
    if (b.target == target && b.channel == channel) own.push_back(k);
    if (problem.targets()[b.target].channels[b.channel].name ==
        problem.targets()[target].channels[channel].name)
      alike.push_back(k);
  }
  return own.empty() ? alike : own;
}

/// Simulated and repeated rows of one draw.
struct Predicted {
  MatrixXd curve, repeated;
};

}  // namespace

std::vector<PredictiveBand> predictive_bands(const Posterior& posterior,
                                             const std::vector<VectorXd>& draws,
                                             std::uint64_t seed) {
  const Problem& problem = posterior.problem();
  std::vector<PredictiveBand> bands;
  for (std::size_t k = 0; k < problem.targets().size(); ++k) {
    const Target& target = problem.targets()[k];
    const auto channels = static_cast<Index>(target.channels.size());
    std::vector<std::vector<std::size_t>> errors;
    PredictiveBand band;
    for (std::size_t c = 0; c < target.channels.size(); ++c) {
      errors.push_back(blocks_for(problem, k, c));
      band.has_errors.push_back(!errors.back().empty() || target.channels[c].noise);
    }
    std::vector<Predicted> predicted(draws.size());
    tbb::parallel_for(std::size_t{0}, draws.size(), [&](std::size_t d) {
      Response response;
      const Misfit m = problem.predict(k, posterior.z(draws[d]), &response);
      if (!response.complete()) return;
      Predicted& p = predicted[d];
      p.curve = p.repeated = m.simulated;
      std::mt19937_64 random(seed + 0x9e3779b97f4a7c15ULL * (d * problem.targets().size() + k + 1));
      for (Index c = 0; c < channels; ++c) {
        const auto at = static_cast<std::size_t>(c);
        const Channel& channel = target.channels[at];
        const std::vector<std::size_t>& from = errors[at];
        CurveError error{channel.noise.value_or(0.0), 0.0, 1.0};
        if (!from.empty()) error = posterior.error(draws[d], from[d % from.size()]);
        VectorXd w(target.rows());
        for (Index i = 0; i < w.size(); ++i) w[i] = scale_of(channel, i) / scale_of(channel);
        p.repeated.col(c) += drawn_error(error, w, random);
      }
    });
    std::erase_if(predicted, [](const Predicted& p) { return p.curve.size() == 0; });
    const auto n = static_cast<Index>(predicted.size());
    const double nothing = std::nan("");
    band.median = band.curve_lower = band.curve_upper = band.lower = band.upper =
        MatrixXd::Constant(target.rows(), channels, nothing);
    for (Index c = 0; c < channels && n > 0; ++c)
      for (Index i = 0; i < target.rows(); ++i) {
        VectorXd curve(n), repeated(n);
        for (Index d = 0; d < n; ++d) {
          curve[d] = predicted[static_cast<std::size_t>(d)].curve(i, c);
          repeated[d] = predicted[static_cast<std::size_t>(d)].repeated(i, c);
        }
        band.median(i, c) = sample_quantile(curve, 0.5);
        band.curve_lower(i, c) = sample_quantile(curve, 0.05);
        band.curve_upper(i, c) = sample_quantile(curve, 0.95);
        band.lower(i, c) = sample_quantile(repeated, 0.05);
        band.upper(i, c) = sample_quantile(repeated, 0.95);
      }
    bands.push_back(std::move(band));
  }
  return bands;
}

double share_inside(const Channel& channel, const PredictiveBand& band, Index column) {
  Index inside = 0;
  for (Index i = 0; i < channel.observed.size(); ++i)
    inside +=
        channel.observed[i] >= band.lower(i, column) && channel.observed[i] <= band.upper(i, column)
            ? 1
            : 0;
  return static_cast<double>(inside) / static_cast<double>(channel.observed.size());
}

}  // namespace repose::calibration
