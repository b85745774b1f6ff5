#pragma once
/// \file
/// How often 90 % credible intervals hold the truth: the exam of docs/posterior.md.

#include "calibration/chains.hpp"
#include "tests/calibration/coverage.hpp"

namespace repose::calibration::posterior_exam {

enum class Kind : std::uint8_t {
  white,       ///< white noise of unknown size; the law is right, and taken to be
  discrepant,  ///< the same noise and an error of the law, which is allowed for
  unaware      ///< the same, and nothing is allowed for
};
inline constexpr std::array kinds{Kind::white, Kind::discrepant, Kind::unaware};
inline constexpr std::array<std::string_view, 3> kind_names{"white", "discrepant", "unaware"};

/// Shares of each channel's range; the length is one of its rows.
inline constexpr double noise = 0.01, discrepancy = 0.03, length = 0.2;

struct Verdict {
  std::array<bool, 5> holds{};
  std::array<double, 5> width{};  ///< of the interval over that of white noise of known size
  int divergent = 0;
};

inline Verdict sit(const exam::Clean& made, Kind kind, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Target> targets = made.targets;
  const CurveError error{noise, kind == Kind::white ? 0.0 : discrepancy, length};
  for (Target& t : targets)
    for (Channel& c : t.channels) {
      const double range = *c.noise / exam::noise;
      c.observed += range * drawn_error(error, Eigen::VectorXd::Ones(t.rows()), random);
      c.noise.reset();
    }
  const Problem problem(ParameterSpace(made.twin.free), std::move(targets));
  const Eigen::VectorXd truth = made.twin.truth_vector();
  const Optimum best = levenberg_marquardt(problem, clipped(problem.space().coordinates(truth)));
  PosteriorOptions options;
  options.chains = 1;
  options.warmup = 50;
  options.draws = 100;
  if (kind == Kind::discrepant) options.discrepancy = 0.1;
  const Posterior posterior(problem, options);
  const Walk walk = walk_from(posterior, best.z);
  std::vector<Eigen::VectorXd> draws;
  Verdict v;
  for (const Draw& d : run_chains(posterior, walk, options, seed))
    if (d.iteration > options.warmup) {
      draws.push_back(posterior.quantities(walk.u(d.w)));
      v.divergent += d.divergent ? 1 : 0;
    }
  for (std::size_t i = 0; i < 5; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    std::vector<double> sorted;
    for (const Eigen::VectorXd& d : draws) sorted.push_back(d[k]);
    std::sort(sorted.begin(), sorted.end());
    // the truth's place among N draws: even over 0 … N where the posterior is right
    const auto place = static_cast<double>(
        std::lower_bound(sorted.begin(), sorted.end(), truth[k]) - sorted.begin());
    const auto n = static_cast<double>(sorted.size());
    v.holds[i] = place >= 0.05 * n && place <= 0.95 * n;
    v.width[i] =
        (sorted[static_cast<std::size_t>(0.95 * n)] - sorted[static_cast<std::size_t>(0.05 * n)]) /
        (2.0 * 1.644853627 * made.error[k]);
  }
  return v;
}

struct Result {
  std::array<double, 5> share{}, width{};  ///< width: median
  double pooled = 0.0;
  int divergent = 0;
};

/// Every round has its own seeds.
inline Result hold(Kind kind, int twins, int round) {
  const exam::Clean made = exam::clean();
  std::vector<Verdict> verdicts(static_cast<std::size_t>(twins));
  tbb::parallel_for(0, twins, [&](int k) {
    const auto seed = static_cast<std::uint64_t>(10'000'000 * round +
                                                 100'000 * (20 + static_cast<int>(kind)) + k + 1);
    verdicts[static_cast<std::size_t>(k)] = sit(made, kind, seed);
  });
  Result r;
  for (std::size_t i = 0; i < 5; ++i) {
    std::vector<double> width;
    for (const Verdict& v : verdicts) {
      r.share[i] += (v.holds[i] ? 1.0 : 0.0) / twins;
      width.push_back(v.width[i]);
      if (i == 0) r.divergent += v.divergent;
    }
    std::sort(width.begin(), width.end());
    r.width[i] = width[width.size() / 2];
    r.pooled += r.share[i] / 5.0;
  }
  return r;
}

}  // namespace repose::calibration::posterior_exam
