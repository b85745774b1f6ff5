#pragma once
/// \file
/// How often the recommended 95 % intervals hold the truth: the exam of docs/fitting.md.

#include <array>
#include <cmath>
#include <string_view>

#include <tbb/parallel_for.h>

#include "calibration/uncertainty.hpp"
#include "study/fit/twin.hpp"

namespace repose::calibration::exam {

using study::Twin;
using study::TwinTest;

enum class Kind : std::uint8_t {
  plain,     ///< linear scales, noise not declared
  declared,  ///< linear scales, noise declared
  log,       ///< λ and κ on logarithmic scales
  ratio,     ///< κ as a share of λ
  bounded,   ///< a bound of κ and one of ν half a standard error from the truth
  prior,     ///< priors of M and κ as strong as the data
  channels,  ///< errors of q and u correlated by 0.8
  ar1,       ///< first-order autoregression of 0.6 along every curve
  smooth     ///< errors with a Gaussian correlation of 1.5 rows
};
inline constexpr std::array kinds{Kind::plain,    Kind::declared, Kind::log,
                                  Kind::ratio,    Kind::bounded,  Kind::prior,
                                  Kind::channels, Kind::ar1,      Kind::smooth};
inline constexpr std::array<std::string_view, 9> kind_names{
    "plain", "declared", "log", "ratio", "bounded", "prior", "channels", "ar1", "smooth"};
inline constexpr std::array<std::string_view, 5> parameter_names{"M", "lambda", "kappa", "nu",
                                                                 "Gamma"};

/// Standard deviation over the range of each channel.
inline constexpr double noise = 0.01;
inline constexpr int rows = 24;

/// Errors of unit variance.
inline Eigen::VectorXd errors(Kind kind, Eigen::Index n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  if (kind == Kind::smooth) {
    // white noise under a Gaussian window of width w has the correlation exp(−k²/(4w²)): w = 1.5/√2
    const double width = 1.5 / std::sqrt(2.0);
    constexpr Eigen::Index reach = 8;
    Eigen::VectorXd white(n + 2 * reach), window(2 * reach + 1);
    for (double& x : white) x = normal(random);
    for (Eigen::Index k = -reach; k <= reach; ++k)
      window[k + reach] = std::exp(-0.5 * std::pow(static_cast<double>(k) / width, 2));
    window /= window.norm();
    Eigen::VectorXd e(n);
    for (Eigen::Index i = 0; i < n; ++i) e[i] = window.dot(white.segment(i, window.size()));
    return e;
  }
  const double rho = kind == Kind::ar1 ? 0.6 : 0.0;
  Eigen::VectorXd e(n);
  for (Eigen::Index i = 0; i < n; ++i)
    e[i] = i == 0 ? normal(random) : rho * e[i - 1] + std::sqrt(1.0 - rho * rho) * normal(random);
  return e;
}

/// Isotropic loading to 800 kPa and back to 100 kPa, and undrained compression to 10 %.
inline std::vector<TwinTest> tests() {
  std::vector<TwinTest> list = study::cam_clay_tests();
  list.resize(2);
  for (TwinTest& t : list) t.tolerance = 1e-7;  // noise is 1e-2
  list[0].abscissae.clear();
  for (int i = 1; i <= rows / 2; ++i)
    list[0].abscissae.push_back(50e3 * std::pow(16.0, i / (rows / 2.0)));
  for (int i = 1; i <= rows / 2; ++i)
    list[0].abscissae.push_back(800e3 * std::pow(8.0, -i / (rows / 2.0)));
  list[1].abscissae = study::evenly(0.0, 0.1, rows);
  return list;
}

/// Without noise, and the standard errors that noise of 1 % gives.
struct Clean {
  Twin twin;
  std::vector<Target> targets;
  Eigen::VectorXd error;
};
inline Clean clean() {
  Clean c;
  c.twin = study::cam_clay_twin();
  c.twin.free[2].of = -1;
  c.twin.free[2].lower = 0.01;
  c.twin.free[2].upper = 0.12;
  c.twin.free[1].scale = Scale::linear;
  c.twin.free[1].lower = 0.125;
  c.twin.free[1].upper = 0.4;
  for (const TwinTest& t : tests()) {
    c.targets.push_back(measure(c.twin, t));
    for (Channel& channel : c.targets.back().channels)
      channel.noise = noise * (channel.observed.maxCoeff() - channel.observed.minCoeff());
  }
  const Problem problem(ParameterSpace(c.twin.free), c.targets);
  const Eigen::VectorXd z = problem.space().coordinates(c.twin.truth_vector());
  c.error = uncertainty(problem, z).white_error;
  return c;
}

/// Does the recommended interval hold the truth: is the excess of a refit at the truth at
/// most 3.84? And, of every 25th twin, how wide is the interval itself over 2·1.96 standard errors
/// of white noise, and does it say the same?
struct Verdict {
  std::array<bool, 5> holds{};
  std::array<double, 5> width{};
  int contradictions = 0;
};

inline Verdict sit(const Clean& made, Kind kind, std::uint64_t seed, bool whole) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Twin twin = made.twin;
  std::vector<Target> targets = made.targets;
  if (kind == Kind::log) {
    twin.free[1].scale = twin.free[2].scale = Scale::log;
  } else if (kind == Kind::ratio) {
    twin.free[2].of = 1;
    twin.free[2].lower = 0.05;
    twin.free[2].upper = 0.9;
  } else if (kind == Kind::bounded) {
    twin.free[2].lower = twin.truth[2] - 0.5 * made.error[2];
    twin.free[3].upper = twin.truth[3] + 0.5 * made.error[3];
  } else if (kind == Kind::prior) {
    for (const std::size_t i : {0U, 2U}) {
      const double sd = made.error[static_cast<Eigen::Index>(i)];
      twin.free[i].prior = Prior{twin.truth[i] + sd * normal(random), sd};
    }
  }
  const bool declared = kind == Kind::declared || kind == Kind::bounded;
  for (Target& t : targets) {
    Eigen::VectorXd first;
    for (Channel& c : t.channels) {
      const double sd = *c.noise;
      Eigen::VectorXd e = errors(kind, t.rows(), random);
      if (kind == Kind::channels && first.size() > 0) e = 0.8 * first + 0.6 * e;
      if (first.size() == 0) first = e;
      c.observed += sd * e;
      if (!declared) c.noise.reset();
    }
  }
  Problem problem(ParameterSpace(twin.free), std::move(targets));
  FitOptions options;
  std::vector<StartResult> starts(1);
  starts[0].optimum =
      levenberg_marquardt(problem, clipped(problem.space().coordinates(twin.truth_vector())));
  settle(problem, options, starts);
  const Eigen::VectorXd z = starts[0].optimum.z;
  const Uncertainty u = uncertainty(problem, z);
  Verdict v;
  for (std::size_t i = 0; i < 5; ++i)
    v.holds[i] = profile_excess(problem, u, z, static_cast<int>(i), twin.truth[i]) <= 3.841458821;
  if (!whole) return v;
  std::vector<Profile> profiles;
  for (int i = 0; i < 5; ++i) profiles.push_back(profile(problem, u, z, i));
  const std::vector<Recommendation> quoted = recommend(problem, u, profiles);
  for (std::size_t i = 0; i < 5; ++i) {
    const bool holds =
        quoted[i].interval[0] <= twin.truth[i] && twin.truth[i] <= quoted[i].interval[1];
    v.contradictions += holds == v.holds[i] ? 0 : 1;
    v.width[i] = (quoted[i].interval[1] - quoted[i].interval[0]) /
                 (2.0 * 1.959963985 * made.error[static_cast<Eigen::Index>(i)]);
  }
  return v;
}

struct Result {
  std::array<double, 5> share{};
  std::array<double, 5> width{};  ///< median
  double pooled = 0.0;
  int contradictions = 0;  ///< between refits at the truth and intervals
};

/// Every round has its own seeds.
inline Result hold(Kind kind, int twins, int round) {
  const Clean made = clean();
  std::vector<Verdict> verdicts(static_cast<std::size_t>(twins));
  tbb::parallel_for(0, twins, [&](int k) {
    const auto seed =
        static_cast<std::uint64_t>(10'000'000 * round + 100'000 * static_cast<int>(kind) + k + 1);
    verdicts[static_cast<std::size_t>(k)] = sit(made, kind, seed, k % 25 == 0);
  });
  Result r;
  for (std::size_t i = 0; i < 5; ++i) {
    std::vector<double> width;
    for (const Verdict& v : verdicts) {
      r.share[i] += (v.holds[i] ? 1.0 : 0.0) / twins;
      if (v.width[i] > 0.0) width.push_back(v.width[i]);
      if (i == 0) r.contradictions += v.contradictions;
    }
    std::sort(width.begin(), width.end());
    r.width[i] = width[width.size() / 2];
    r.pooled += r.share[i] / 5.0;
  }
  return r;
}

}  // namespace repose::calibration::exam
