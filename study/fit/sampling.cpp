#include "study/fit/sampling.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/fingerprint.hpp"

namespace repose::study {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Curves are simulated for so many draws at most: enough for a 5 % quantile.
constexpr std::size_t most_curves = 400;

constexpr double largest_r_hat = 1.01;
constexpr double least_size_per_chain = 100.0;

QuantitySummary summary_of(const std::string& name, const std::string& unit,
                           const MatrixXd& draws) {
  QuantitySummary s;
  s.name = name;
  s.unit = unit;
  const VectorXd all = draws.reshaped();
  s.mean = all.mean();
  s.sd = std::sqrt((all.array() - s.mean).square().sum() / static_cast<double>(all.size() - 1));
  s.median = calibration::sample_quantile(all, 0.5);
  s.interval_90 = {calibration::sample_quantile(all, 0.05),
                   calibration::sample_quantile(all, 0.95)};
  s.interval_95 = {calibration::sample_quantile(all, 0.025),
                   calibration::sample_quantile(all, 0.975)};
  s.convergence = calibration::convergence(draws);
  return s;
}

/// What speaks against the draws.
std::vector<std::string> complaints_of(const PosteriorResult& result) {
  std::vector<std::string> texts;
  const QuantitySummary *apart = nullptr, *few = nullptr;
  const auto size = [](const QuantitySummary& s) {
    return std::min(s.convergence.bulk_ess, s.convergence.tail_ess);
  };
  for (const QuantitySummary& s : result.summary) {
    if (!(s.convergence.r_hat <= largest_r_hat) &&
        (apart == nullptr || !(s.convergence.r_hat <= apart->convergence.r_hat)))
      apart = &s;
    if (!(size(s) >= least_size_per_chain * result.chains) &&
        (few == nullptr || !(size(s) >= size(*few))))
      few = &s;
  }
  if (apart != nullptr)
    texts.push_back(
        fmt::format("the chains do not agree on {} (R-hat {:.3f}, at most {} wanted): "
                    "more posterior.warmup and posterior.draws",
                    apart->name, apart->convergence.r_hat, largest_r_hat));
  if (few != nullptr)
    texts.push_back(
        fmt::format("the draws of {} are worth {:.0f} independent ones, {:.0f} wanted: "
                    "more posterior.draws",
                    few->name, size(*few), least_size_per_chain * result.chains));
  if (result.divergent > 0)
    texts.push_back(
        fmt::format("{} of {} draws are divergent: the density has corners that the "
                    "step is too long for; posterior.accept = 0.95 shortens it",
                    result.divergent, result.kept));
  if (result.longest > 0)
    texts.push_back(
        fmt::format("{} of {} trajectories were cut off before they turned: two "
                    "combinations of parameters are hardly told apart",
                    result.longest, result.kept));
  return texts;
}

}  // namespace

Sampler::Sampler(const input::FitFile& file, const calibration::Problem& problem, const VectorXd& z)
    : posterior(problem, *file.posterior),
      walk(calibration::walk_from(posterior, z)) {
  const calibration::PosteriorOptions& o = *file.posterior;
  // chains and draws are left out: more of them go on from those there are
  std::string key = fmt::format("{} {} {} {} {}", file.fingerprint, o.warmup, o.discrepancy,
                                o.keep_declared_noise, o.accept);
  for (const double x : walk.mode) key += fmt::format(" {}", x);
  for (const double x : walk.root.reshaped()) key += fmt::format(" {}", x);
  fingerprint = io::fingerprint_of(key);
}

PosteriorResult sample(const input::FitFile& file, const Sampler& sampler,
                       const SampleRequest& request) {
  const calibration::PosteriorOptions& options = *file.posterior;
  const int last = options.warmup + options.draws;
  PosteriorResult result;
  std::vector<calibration::Draw> done;
  for (const calibration::Draw& d : request.done)
    if (d.chain < options.chains && d.iteration <= last) done.push_back(d);
  result.draws = calibration::run_chains(sampler.posterior, sampler.walk, options,
                                         file.options.seed, done, request.after_draw);
  for (const calibration::Draw& d : result.draws) {
    result.chains += d.iteration == last ? 1 : 0;
    result.leapfrogs += d.leapfrogs;
    result.broken += d.broken;
  }
  result.complete = result.chains == options.chains;
  if (!result.complete) return result;

  const std::vector<std::string> names = sampler.posterior.quantity_names();
  const auto quantities = static_cast<Index>(names.size());
  std::vector<VectorXd> u;
  result.quantities.resize(static_cast<Index>(options.chains) * options.draws, quantities);
  for (const calibration::Draw& d : result.draws) {
    if (d.iteration <= options.warmup) continue;
    u.push_back(sampler.walk.u(d.w));
    result.quantities.row(result.kept++) = sampler.posterior.quantities(u.back()).transpose();
    result.divergent += d.divergent ? 1 : 0;
    result.longest += d.longest ? 1 : 0;
    result.accept += d.accept;
  }
  result.accept /= result.kept;
  for (Index q = 0; q < quantities; ++q) {
    const auto k = static_cast<std::size_t>(q);
    const VectorXd column = result.quantities.col(q);
    result.summary.push_back(
        summary_of(names[k], k < file.free.size() ? file.free[k].unit : "",
                   Eigen::Map<const MatrixXd>(column.data(), options.draws, options.chains)));
  }
  const MatrixXd centred = result.quantities.rowwise() - result.quantities.colwise().mean();
  const MatrixXd products = centred.transpose() * centred;
  const VectorXd size = products.diagonal().cwiseSqrt();
  result.correlation = products.cwiseQuotient(size * size.transpose());
  std::vector<VectorXd> some;
  const std::size_t step = (u.size() + most_curves - 1) / most_curves;
  for (std::size_t k = 0; k < u.size(); k += step) some.push_back(u[k]);
  result.bands = calibration::predictive_bands(sampler.posterior, some, file.options.seed);
  result.complaints = complaints_of(result);
  for (const QuantitySummary& s : result.summary)
    result.converged = result.converged && s.convergence.r_hat <= largest_r_hat &&
                       std::min(s.convergence.bulk_ess, s.convergence.tail_ess) >=
                           least_size_per_chain * result.chains;
  return result;
}

}  // namespace repose::study
