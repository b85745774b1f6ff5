// The posterior against closed forms: errors along a curve, densities and their slopes, draws of a
// linear fit, and the bits of chains that are shared out, stopped and taken up again.

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "calibration/chains.hpp"
#include "calibration/convergence.hpp"
#include "calibration/multistart.hpp"
#include "calibration/predictive.hpp"
#include "calibration/quantiles.hpp"
#include "tests/calibration/toy.hpp"

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd covariance(const CurveError& error, const VectorXd& w) {
  const Index n = w.size();
  MatrixXd C(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const double apart = static_cast<double>(std::abs(i - j)) / static_cast<double>(n - 1);
      C(i, j) = error.discrepancy * error.discrepancy * std::exp(-apart / error.length) +
                (i == j ? std::pow(error.noise * w[i], 2) : 0.0);
    }
  return C;
}

TEST(CurveError, HasTheLikelihoodAndTheSlopesOfItsCovariance) {
  const Index n = 9;
  VectorXd e(n), w(n);
  for (Index i = 0; i < n; ++i) {
    e[i] = std::sin(1.7 * static_cast<double>(i)) + 0.3;
    w[i] = 0.5 + 0.1 * static_cast<double>(i);
  }
  for (const CurveError error : {CurveError{0.4, 0.7, 0.3}, CurveError{0.9, 0.0, 1.0}}) {
    const MatrixXd C = covariance(error, w);
    const CurveLikelihood l = likelihood(error, e, w);
    const VectorXd solved = C.ldlt().solve(e);
    const double log_det = C.ldlt().vectorD().array().log().sum();
    // nine rows of round-off
    EXPECT_NEAR(l.value, -0.5 * (e.dot(solved) + log_det), 1e-12);
    EXPECT_LT((l.by_row + solved).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_NEAR(innovations(error, e, w).squaredNorm(), e.dot(solved), 1e-12);
    for (int k = 0; k < 3; ++k) {
      if (k > 0 && error.discrepancy == 0.0) continue;
      constexpr double h = 1e-5;
      std::array<double, 2> side{};
      for (const int s : {0, 1}) {
        CurveError moved = error;
        (k == 0   ? moved.noise
         : k == 1 ? moved.discrepancy
                  : moved.length) *= std::exp(s == 0 ? -h : h);
        side[static_cast<std::size_t>(s)] = likelihood(moved, e, w).value;
      }
      // h² of the third derivative, of order 10
      EXPECT_NEAR(l.by_logarithm[static_cast<std::size_t>(k)], (side[1] - side[0]) / (2.0 * h),
                  1e-8);
    }
  }
}

TEST(CurveError, IsDrawnWithItsCovariance) {
  const CurveError error{0.4, 0.7, 0.3};
  const VectorXd w = VectorXd::LinSpaced(5, 0.5, 1.0);
  const MatrixXd C = covariance(error, w);
  std::mt19937_64 random(3);
  constexpr int draws = 40000;
  MatrixXd sum = MatrixXd::Zero(5, 5);
  for (int d = 0; d < draws; ++d) {
    const VectorXd e = drawn_error(error, w, random);
    sum += e * e.transpose() / draws;
  }
  // a product of two normals has a variance of at most 2 C²; five standard deviations
  EXPECT_LT((sum - C).cwiseAbs().maxCoeff(), 5.0 * std::sqrt(2.0 / draws) * C.maxCoeff());
}

/// y = a + b x with errors, b free on the given scale, noise declared or not.
Problem line_problem(const VectorXd& errors, std::optional<double> noise,
                     std::vector<FreeParameter> free) {
  const Index n = errors.size();
  std::vector<double> x;
  for (Index i = 0; i < n; ++i) x.push_back(static_cast<double>(i) / static_cast<double>(n - 1));
  Target t;
  t.name = "line";
  t.simulator = std::make_shared<Line>(x);
  t.inputs = {1.0, 2.0};
  for (std::size_t k = 0; k < free.size(); ++k)
    t.bindings.push_back({free[k].name == "a" ? 0 : 1, static_cast<int>(k)});
  t.x = Eigen::Map<const VectorXd>(x.data(), n);
  t.channels.push_back({"y", ((1.0 + 2.0 * t.x.array()).matrix() + errors).eval(), noise, 1.0});
  return Problem(ParameterSpace(std::move(free)), {t});
}

VectorXd white(Index n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  VectorXd e(n);
  for (double& x : e) x = normal(random);
  return e;
}

std::vector<FreeParameter> wide_line() {
  return {free_parameter("a", -9.0, 11.0), free_parameter("b", -8.0, 12.0)};
}

std::vector<VectorXd> kept(const Posterior& posterior, const Walk& walk,
                           const PosteriorOptions& options, const std::vector<Draw>& draws) {
  std::vector<VectorXd> list;
  for (const Draw& d : draws)
    if (d.iteration > options.warmup) list.push_back(posterior.quantities(walk.u(d.w)));
  return list;
}

VectorXd mean_of(const std::vector<VectorXd>& draws) {
  VectorXd sum = VectorXd::Zero(draws.front().size());
  for (const VectorXd& d : draws) sum += d;
  return sum / static_cast<double>(draws.size());
}

MatrixXd covariance_of(const std::vector<VectorXd>& draws) {
  const VectorXd mean = mean_of(draws);
  MatrixXd sum = MatrixXd::Zero(mean.size(), mean.size());
  for (const VectorXd& d : draws) sum += (d - mean) * (d - mean).transpose();
  return sum / static_cast<double>(draws.size() - 1);
}

TEST(Posterior, OfALinearFitWithKnownNoiseIsLaplaces) {
  const Index n = 30;
  const double sd = 0.2;
  const Problem problem = line_problem(sd * white(n, 5), sd, wide_line());
  PosteriorOptions options;
  options.keep_declared_noise = true;
  options.draws = 5000;
  const Posterior posterior(problem, options);
  const Walk walk = walk_from(posterior, problem.space().start());
  const std::vector<Draw> draws = run_chains(posterior, walk, options, 1);
  const std::vector<VectorXd> values = kept(posterior, walk, options, draws);
  // the closed form: A = [1 x], covariance sd² (AᵀA)⁻¹
  MatrixXd A(n, 2);
  A.col(0).setOnes();
  A.col(1) = problem.targets()[0].x;
  const VectorXd y = problem.targets()[0].channels[0].observed;
  const MatrixXd exact = sd * sd * (A.transpose() * A).inverse();
  const VectorXd best = (A.transpose() * A).ldlt().solve(A.transpose() * y);
  const VectorXd mean = mean_of(values);
  const MatrixXd found = covariance_of(values);
  for (Index i = 0; i < 2; ++i) {
    const double error = std::sqrt(exact(i, i));
    std::printf("[ measured ] mean off by %.4f, deviation by %.4f standard errors\n",
                (mean[i] - best[i]) / error, std::sqrt(found(i, i)) / error - 1.0);
    // 20000 draws, worth 5000 at the least: 1/√5000 of a mean, 1/√10000 of a deviation
    EXPECT_NEAR(mean[i], best[i], 0.03 * error);
    EXPECT_NEAR(std::sqrt(found(i, i)), error, 0.03 * error);
  }
  EXPECT_NEAR(found(0, 1) / std::sqrt(found(0, 0) * found(1, 1)),
              exact(0, 1) / std::sqrt(exact(0, 0) * exact(1, 1)), 0.03);
  for (const Draw& d : draws) EXPECT_FALSE(d.divergent && d.iteration > options.warmup);
}

TEST(Posterior, OfALinearFitWithUnknownNoiseIsStudents) {
  const Index n = 8;
  const Problem problem = line_problem(0.2 * white(n, 6), {}, wide_line());
  PosteriorOptions options;
  options.draws = 8000;
  const Posterior posterior(problem, options);
  const Walk walk = walk_from(posterior, problem.space().start());
  const std::vector<VectorXd> values =
      kept(posterior, walk, options, run_chains(posterior, walk, options, 2));
  MatrixXd A(n, 2);
  A.col(0).setOnes();
  A.col(1) = problem.targets()[0].x;
  const VectorXd y = problem.targets()[0].channels[0].observed;
  const VectorXd best = (A.transpose() * A).ldlt().solve(A.transpose() * y);
  const double squares = (y - A * best).squaredNorm();
  const double unit = std::sqrt((A.transpose() * A).inverse()(1, 1));
  VectorXd slope(static_cast<Index>(values.size()));
  for (Index d = 0; d < slope.size(); ++d) slope[d] = values[static_cast<std::size_t>(d)][1];
  const double half = 0.5 * (sample_quantile(slope, 0.975) - sample_quantile(slope, 0.025));
  // By quadrature over ln σ: b is normal of deviation σ unit, and σ has the weight
  // σ^−(n−2) exp(−squares/2σ²) times its prior, about 1 % of the range and 3 wide in ln σ
  const double centre = 0.01 * (y.maxCoeff() - y.minCoeff());
  double weight = 0.0, outside = 0.0;
  for (double ln = std::log(centre) - 8.0; ln < std::log(centre) + 12.0; ln += 1e-3) {
    const double sigma = std::exp(ln), off = (ln - std::log(centre)) / 3.0;
    const double p = std::exp(-static_cast<double>(n - 2) * ln - 0.5 * squares / (sigma * sigma) -
                              0.5 * off * off);
    weight += p;
    outside += p * std::erfc(half / (sigma * unit * std::sqrt(2.0)));
  }
  std::printf(
      "[ measured ] %.4f of the distribution beyond the draws' 95 %%; Student's 95 %%: %.3f of "
      "theirs\n",
      outside / weight,
      t_quantile(static_cast<double>(n - 2)) * std::sqrt(squares / static_cast<double>(n - 2)) *
          unit / half);
  // 32000 draws, worth 8000 at the least: √(0.05 · 0.95/8000), three of them
  EXPECT_NEAR(outside / weight, 0.05, 0.0075);
}

TEST(Posterior, WithADiscrepancyWeighsRowsByItsCovariance) {
  // the errors' own parameters where the draws put them, so that the rest has a closed form
  const Index n = 40;
  std::mt19937_64 random(9);
  const CurveError truth{0.05, 0.3, 0.2};
  const Problem problem =
      line_problem(drawn_error(truth, VectorXd::Ones(n), random), {}, wide_line());
  PosteriorOptions options;
  options.discrepancy = 0.1;
  options.draws = 4000;
  const Posterior posterior(problem, options);
  const Walk walk = walk_from(posterior, problem.space().start());
  const std::vector<Draw> draws = run_chains(posterior, walk, options, 4);
  MatrixXd A(n, 2);
  A.col(0).setOnes();
  A.col(1) = problem.targets()[0].x;
  const VectorXd y = problem.targets()[0].channels[0].observed;
  // law of total variance over the draws of the errors
  std::vector<VectorXd> centres;
  MatrixXd inner = MatrixXd::Zero(2, 2);
  int count = 0;
  for (const Draw& d : draws) {
    if (d.iteration <= options.warmup || d.iteration % 20 != 0) continue;
    const MatrixXd C = covariance(posterior.error(walk.u(d.w), 0), VectorXd::Ones(n));
    const MatrixXd CA = C.ldlt().solve(A);
    const MatrixXd V = (A.transpose() * CA).inverse();
    centres.push_back(V * (CA.transpose() * y));
    inner += V;
    ++count;
  }
  const MatrixXd exact = inner / count + covariance_of(centres);
  const std::vector<VectorXd> values = kept(posterior, walk, options, draws);
  const MatrixXd found = covariance_of(values).topLeftCorner(2, 2);
  const VectorXd mean = mean_of(values), centre = mean_of(centres);
  for (Index i = 0; i < 2; ++i) {
    // 800 sets of errors: 1/√1600 of a deviation, twice that
    EXPECT_NEAR(std::sqrt(found(i, i) / exact(i, i)), 1.0, 0.05);
    EXPECT_NEAR(mean[i], centre[i], 0.08 * std::sqrt(exact(i, i)));
  }
  // white noise would have it known ten times as well
  const MatrixXd naive = 0.09 * (A.transpose() * A).inverse();
  EXPECT_GT(found(0, 0), 4.0 * naive(0, 0));
}

/// A decay with every kind of parameter: on a logarithm with a prior, a ratio with a relative one.
Problem decay_with_priors(double below_of = 0.0) {
  const Target t = decay_target(std::make_shared<Decay>(decay_x()), 2.0, 1.3,
                                0.02 * white(static_cast<Index>(decay_x().size()), 11));
  std::vector<FreeParameter> free{free_parameter("a", 0.5, 6.0, Scale::log),
                                  free_parameter("b", 0.2, 3.0)};
  free[0].prior = Prior{1.9, 0.4};
  if (below_of > 0.0) {
    free[1].below = 0;
    free[1].scale = Scale::log;
    free[1].prior = Prior{1.2, 0.3};
  } else {
    free[1].of = 0;
    free[1].lower = 0.1;
    free[1].upper = 1.5;
    free[1].prior = Prior{1.2, 0.3, true};
  }
  return Problem(ParameterSpace(std::move(free)), {t});
}

TEST(Posterior, HasTheSlopesOfItsDensity) {
  for (const double below : {0.0, 1.0}) {
    const Problem problem = decay_with_priors(below);
    PosteriorOptions options;
    options.discrepancy = 0.1;
    const Posterior posterior(problem, options);
    VectorXd u = posterior.start(problem.space().coordinates(Eigen::Vector2d(2.0, 1.3)));
    u[0] += 0.3;
    u[1] -= 0.2;
    Posterior::Point at, up, down;
    posterior.evaluate(u, true, at);
    EXPECT_GT(Eigen::LLT<MatrixXd>(at.curvature).matrixL().toDenseMatrix().diagonal().minCoeff(),
              0.0);
    for (Index i = 0; i < posterior.size(); ++i) {
      constexpr double h = 1e-5;
      VectorXd v = u;
      v[i] += h;
      posterior.evaluate(v, false, up);
      v[i] -= 2.0 * h;
      posterior.evaluate(v, false, down);
      const double slope = (up.log_density - down.log_density) / (2.0 * h);
      // h² of third derivatives of some 1e4
      EXPECT_NEAR(at.gradient[i], slope, 1e-6 * (1.0 + std::abs(slope))) << i;
    }
  }
}

TEST(Posterior, IsThePriorWhereTheDataSayNothing) {
  std::vector<FreeParameter> free = wide_line();
  free[1] = free_parameter("b", 0.1, 40.0, Scale::log);
  free[1].prior = Prior{2.0, 0.4};  // normal in the value, though the scale is a logarithm
  const Problem problem = line_problem(white(10, 7), 1e6, free);
  PosteriorOptions options;
  options.keep_declared_noise = true;
  options.draws = 5000;
  const Posterior posterior(problem, options);
  const Walk walk = walk_from(posterior, problem.space().coordinates(Eigen::Vector2d(1.0, 2.0)));
  const std::vector<VectorXd> values =
      kept(posterior, walk, options, run_chains(posterior, walk, options, 3));
  const VectorXd mean = mean_of(values);
  const MatrixXd C = covariance_of(values);
  // a: even over −9 to 11, b: the prior; 20000 draws, worth 5000 at the least
  EXPECT_NEAR(mean[0], 1.0, 4.0 * 5.8 / std::sqrt(5000.0));
  EXPECT_NEAR(std::sqrt(C(0, 0)), 20.0 / std::sqrt(12.0), 0.15);
  EXPECT_NEAR(mean[1], 2.0, 4.0 * 0.4 / std::sqrt(5000.0));
  EXPECT_NEAR(std::sqrt(C(1, 1)), 0.4, 4.0 * 0.4 / std::sqrt(10000.0));
}

TEST(Posterior, OfABoundBesideTheOptimumStaysInside) {
  std::vector<FreeParameter> free = wide_line();
  free[1].lower = 2.3;  // the truth is 2, 0.2 standard errors and more below
  const Problem problem = line_problem(0.2 * white(20, 8), 0.2, free);
  PosteriorOptions options;
  options.keep_declared_noise = true;
  const Posterior posterior(problem, options);
  const Walk walk = walk_from(posterior, problem.space().start());
  const std::vector<Draw> draws = run_chains(posterior, walk, options, 3);
  int divergent = 0;
  for (const Draw& d : draws) divergent += d.divergent && d.iteration > options.warmup ? 1 : 0;
  // in u the density falls off beside a bound like exp(−exp u): a step may be too long for that
  EXPECT_LT(divergent, 40);
  VectorXd slope(options.chains * options.draws);
  Index k = 0;
  for (const VectorXd& v : kept(posterior, walk, options, draws)) slope[k++] = v[1];
  EXPECT_GT(slope.minCoeff(), 2.3);
  // half of a normal distribution's lower tail: against its quadrature on a fine lattice
  MatrixXd A(20, 2);
  A.col(0).setOnes();
  A.col(1) = problem.targets()[0].x;
  const VectorXd y = problem.targets()[0].channels[0].observed;
  const VectorXd best = (A.transpose() * A).ldlt().solve(A.transpose() * y);
  const double error = 0.2 * std::sqrt((A.transpose() * A).inverse()(1, 1));
  double weight = 0.0, mean = 0.0;
  for (double b = 2.3; b < 6.0; b += 1e-4) {
    const double p = std::exp(-0.5 * std::pow((b - best[1]) / error, 2));
    weight += p;
    mean += b * p;
  }
  mean /= weight;
  // a tail's deviation is about its mean excess; 4000 draws, worth 1000 at the least
  EXPECT_NEAR(slope.mean(), mean, 4.0 * (mean - 2.3) / std::sqrt(1000.0));
}

bool same_bits(const std::vector<Draw>& a, const std::vector<Draw>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (a[k].w != b[k].w || a[k].log_density != b[k].log_density || a[k].chain != b[k].chain ||
        a[k].adaptation != b[k].adaptation || a[k].leapfrogs != b[k].leapfrogs)
      return false;
  return true;
}

TEST(Chains, HaveTheSameBitsOnAnyThreadsInAnySharesAndAfterAnyStop) {
  Problem problem = decay_with_priors();
  PosteriorOptions options;
  options.warmup = 30;
  options.draws = 40;
  options.discrepancy = 0.1;
  const Posterior posterior(problem, options);
  const Walk walk = walk_from(posterior, problem.space().start());
  const std::vector<Draw> whole = run_chains(posterior, walk, options, 5);
  ASSERT_EQ(whole.size(), 4u * 71u);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_TRUE(same_bits(whole, run_chains(posterior, walk, options, 5)));
  }
  std::vector<Draw> shares;
  for (const int from : {0, 1, 3}) {
    PosteriorOptions share = options;
    share.chains_from = from;
    share.chains_to = from == 0 ? 1 : from == 1 ? 3 : 4;
    for (const Draw& d : run_chains(posterior, walk, share, 5)) shares.push_back(d);
  }
  EXPECT_TRUE(same_bits(whole, shares));
  // stopped in the warm-up, at its end and among the draws that are kept
  for (const int stop : {0, 1, 17, 30, 31, 55}) {
    std::vector<Draw> done;
    for (const Draw& d : whole)
      if (d.iteration <= stop + d.chain) done.push_back(d);
    EXPECT_TRUE(same_bits(whole, run_chains(posterior, walk, options, 5, done))) << stop;
  }
  EXPECT_FALSE(same_bits(whole, run_chains(posterior, walk, options, 6)));
}

TEST(Chains, StopWhereTheyAreInterrupted) {
  Problem problem = decay_with_priors();
  std::atomic<int> count{0};
  problem.interrupt_by([&] { return count > 25; });
  PosteriorOptions options;
  const Posterior posterior(problem, options);
  const Walk walk = walk_from(posterior, problem.space().start());
  const std::vector<Draw> draws =
      run_chains(posterior, walk, options, 5, {}, [&](const Draw&) { ++count; });
  EXPECT_LT(draws.size(), 40u);
  EXPECT_GE(draws.size(), 4u);
}

TEST(Chains, KeepOutOfWhatBreaksOff) {
  // paths with b > 1.6 break off: beyond it there is nothing
  const Target t = decay_target(std::make_shared<Decay>(decay_x(), Trap::breaks_off, 1.6), 2.0,
                                1.55, 0.1 * white(static_cast<Index>(decay_x().size()), 12));
  const Problem problem(
      ParameterSpace({free_parameter("a", 0.1, 10.0), free_parameter("b", 0.05, 6.0)}), {t});
  PosteriorOptions options;
  options.draws = 300;
  const Posterior posterior(problem, options);
  const Walk walk = walk_from(posterior, problem.space().coordinates(Eigen::Vector2d(2.0, 1.5)));
  long broken = 0;
  for (const Draw& d : run_chains(posterior, walk, options, 8)) {
    EXPECT_LE(posterior.quantities(walk.u(d.w))[1], 1.6);
    EXPECT_FALSE(d.divergent && d.iteration > options.warmup);
    broken += d.broken;
  }
  EXPECT_GT(broken, 0);
}

TEST(Convergence, KnowsIndependentDrawsFromSlowAndFromSeparateOnes) {
  constexpr Index n = 2000;
  std::mt19937_64 random(21);
  std::normal_distribution<double> normal;
  MatrixXd independent(n, 4), slow(n, 4);
  constexpr double rho = 0.8;
  for (Index c = 0; c < 4; ++c) {
    double x = normal(random);
    for (Index i = 0; i < n; ++i) {
      independent(i, c) = normal(random);
      x = rho * x + std::sqrt(1.0 - rho * rho) * normal(random);
      slow(i, c) = std::exp(x);  // ranks do not mind
    }
  }
  const Convergence a = convergence(independent), b = convergence(slow);
  EXPECT_NEAR(a.r_hat, 1.0, 0.005);
  EXPECT_NEAR(a.bulk_ess, 8000.0, 1200.0);
  EXPECT_NEAR(a.tail_ess, 8000.0, 1600.0);
  // n (1 − ρ)/(1 + ρ)
  EXPECT_NEAR(b.bulk_ess, 8000.0 / 9.0, 250.0);
  EXPECT_LT(b.r_hat, 1.03);
  MatrixXd apart = independent;
  apart.col(2).array() += 1.0;
  EXPECT_GT(convergence(apart).r_hat, 1.05);
  MatrixXd wide = independent;  // the same place, another spread: only the folded ranks see it
  wide.col(1) *= 3.0;
  EXPECT_GT(convergence(wide).r_hat, 1.05);
  EXPECT_TRUE(std::isnan(convergence(MatrixXd::Ones(10, 4)).r_hat));
}

TEST(Predictive, BandsOfALineHoldTheirShare) {
  const Index n = 400;
  Problem problem = line_problem(0.2 * white(n, 30), {}, wide_line());
  std::vector<Target> targets = problem.targets();
  Target unseen = targets[0];
  unseen.name = "unseen";
  unseen.held_out = true;
  unseen.channels[0].observed = (1.0 + 2.0 * unseen.x.array()).matrix() + 0.2 * white(n, 31);
  targets.push_back(unseen);
  const Problem both(problem.space(), targets);
  PosteriorOptions options;
  const Posterior posterior(both, options);
  const Walk walk = walk_from(posterior, both.space().start());
  std::vector<VectorXd> u;
  for (const Draw& d : run_chains(posterior, walk, options, 2))
    if (d.iteration > options.warmup && d.iteration % 8 == 0) u.push_back(walk.u(d.w));
  const std::vector<PredictiveBand> bands = predictive_bands(posterior, u, 1);
  for (std::size_t k = 0; k < 2; ++k) {
    // binomial: √(0.9 · 0.1/400) = 1.5 %, and what the band itself is off by; three of them
    EXPECT_NEAR(share_inside(both.targets()[k].channels[0], bands[k], 0), 0.9, 0.05);
    EXPECT_GT(bands[k].curve_lower(0, 0), bands[k].lower(0, 0));
    EXPECT_TRUE(bands[k].has_errors[0]);
  }
}

}  // namespace
}  // namespace repose::calibration
