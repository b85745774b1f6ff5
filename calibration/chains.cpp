#include "calibration/chains.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include <Eigen/Cholesky>
#include <tbb/parallel_for.h>

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int most_doublings = 10;
constexpr double largest_error = 1000.0;  // of the energy

/// SplitMix64's finaliser (Steele, Lea & Flood 2014): neighbouring numbers come out unlike.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// The random numbers of one draw.
class Random {
 public:
  Random(std::uint64_t seed, int chain, int iteration)
      : engine_(mixed(mixed(mixed(seed) + static_cast<std::uint64_t>(chain)) +
                      static_cast<std::uint64_t>(iteration))) {}
  double even() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  VectorXd normal(Index n) {
    VectorXd x(n);
    for (double& xi : x) xi = normal_(engine_);
    return x;
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

double log_sum(double a, double b) {
  const double most = std::max(a, b);
  return most == -infinity ? most : most + std::log(std::exp(a - most) + std::exp(b - most));
}

/// A chain's inverse mass matrix A, and its Cholesky factor: p = L⁻ᵀ n has the covariance A⁻¹.
struct Metric {
  MatrixXd inverse_mass, lower;
};

/// Where the warm-up takes a new metric, and begins to set its step anew.
struct Phases {
  explicit Phases(int warmup) : second(warmup / 4), third(warmup / 2) {}
  /// The last iteration before the phase of an iteration.
  int begin(int iteration) const {
    return iteration <= second ? 0 : iteration <= third ? second : third;
  }
  int second, third;
};

/// The covariance of what the chain has drawn in the phase before (of the first phase, in its
/// second half), and of the curvature at the mode, the identity, as if five draws were worth that.
Metric metric_of(const std::vector<Draw>& draws, Index size, int begin, const Phases& phases) {
  constexpr double worth = 5.0;
  MatrixXd A = worth * MatrixXd::Identity(size, size);
  const int from =
      begin == phases.third && phases.third > phases.second ? phases.second : begin / 2;
  VectorXd mean = VectorXd::Zero(size);
  for (int i = from + 1; i <= begin; ++i)
    mean += draws[static_cast<std::size_t>(i)].w / (begin - from);
  for (int i = from + 1; i <= begin; ++i) {
    const VectorXd off = draws[static_cast<std::size_t>(i)].w - mean;
    A += off * off.transpose();
  }
  A /= worth + (begin - from);
  return {A, A.llt().matrixL()};
}

/// A place with its momentum and its velocity A p.
struct State {
  VectorXd w, p, v, gradient;
  double log_density = 0.0;
};

/// A stretch of trajectory.
struct Tree {
  State left, right;
  State drawn;              ///< one of its places, by their weights
  double log_weight = 0.0;  ///< ln Σ exp(−energy)
  VectorXd momentum;        ///< Σ p
  bool goes_on = true;      ///< it has not turned, nor left what can be followed
};

/// One draw.
class Trajectory {
 public:
  Trajectory(const Posterior& posterior, const Walk& walk, const Metric& metric, double step,
             Random random, Draw& draw)
      : posterior_(posterior),
        walk_(walk),
        metric_(metric),
        step_(step),
        random_(std::move(random)),
        draw_(draw) {}

  State place(const VectorXd& w) const {
    Posterior::Point at;
    posterior_.evaluate(walk_.u(w), false, at);
    return {w, {}, {}, walk_.root.transpose() * at.gradient, at.log_density};
  }

  /// From a place to the next; counts into the draw.
  State next(State from) {
    from.p = metric_.lower.transpose().triangularView<Eigen::Upper>().solve(
        random_.normal(from.w.size()));
    from.v = metric_.inverse_mass * from.p;
    start_energy_ = energy(from);
    Tree whole{from, from, from, -start_energy_, from.p, true};
    for (int doublings = 0; whole.goes_on; ++doublings) {
      if (doublings == most_doublings) {
        draw_.longest = true;
        break;
      }
      const bool forwards = random_.even() < 0.5;
      Tree more = grown(forwards ? whole.right : whole.left, doublings, forwards);
      if (!more.goes_on) break;
      // towards the new half where it weighs more (Betancourt 2017, A.3.2)
      if (std::log(random_.even()) < more.log_weight - whole.log_weight) whole.drawn = more.drawn;
      join(whole, std::move(more), forwards);
    }
    draw_.accept = trials_ > 0 ? accepted_ / trials_ : 0.0;
    draw_.leapfrogs = trials_;
    return whole.drawn;
  }

 private:
  static double energy(const State& s) { return 0.5 * s.p.dot(s.v) - s.log_density; }

  /// 2^depth steps on from an end.
  Tree grown(const State& from, int depth, bool forwards) {
    if (depth == 0) return leapfrog(from, forwards);
    Tree tree = grown(from, depth - 1, forwards);
    if (!tree.goes_on) return tree;
    Tree more = grown(forwards ? tree.right : tree.left, depth - 1, forwards);
    if (!more.goes_on) {
      tree.goes_on = false;
      return tree;
    }
    const double share = more.log_weight - log_sum(tree.log_weight, more.log_weight);
    if (std::log(random_.even()) < share) tree.drawn = more.drawn;
    join(tree, std::move(more), forwards);
    return tree;
  }

  Tree leapfrog(const State& from, bool forwards) {
    const double step = forwards ? step_ : -step_;
    const VectorXd half = from.p + 0.5 * step * from.gradient;
    State to = place(from.w + step * (metric_.inverse_mass * half));
    to.p = half + 0.5 * step * to.gradient;
    to.v = metric_.inverse_mass * to.p;
    const bool broken = to.log_density == -infinity;
    const double error = broken ? infinity : energy(to) - start_energy_;
    ++trials_;
    if (error < infinity) accepted_ += std::min(1.0, std::exp(-error));
    draw_.broken += broken ? 1 : 0;
    const bool lost = !(error < largest_error);
    draw_.divergent = draw_.divergent || (lost && !broken);
    const double weight = broken ? -infinity : -energy(to);
    VectorXd p = to.p;
    return {to, to, to, weight, std::move(p), !lost};
  }

  /// Adds a stretch at an end; the whole goes on as long as both ends move apart.
  static void join(Tree& tree, Tree&& more, bool forwards) {
    const State first = forwards ? tree.left : tree.right,
                outer = forwards ? tree.right : tree.left;
    const State inner = forwards ? more.left : more.right;
    State last = forwards ? std::move(more.right) : std::move(more.left);
    // neither the whole, nor one half with the first of the other, has turned
    tree.goes_on = apart(tree.momentum + more.momentum, first, last) &&
                   apart(tree.momentum + inner.p, first, inner) &&
                   apart(more.momentum + outer.p, outer, last);
    tree.momentum += more.momentum;
    tree.log_weight = log_sum(tree.log_weight, more.log_weight);
    (forwards ? tree.right : tree.left) = std::move(last);
  }
  static bool apart(const VectorXd& momentum, const State& first, const State& last) {
    return momentum.dot(first.v) > 0.0 && momentum.dot(last.v) > 0.0;
  }

  const Posterior& posterior_;
  const Walk& walk_;
  const Metric& metric_;
  double step_;
  Random random_;
  Draw& draw_;
  double start_energy_ = 0.0, accepted_ = 0.0;
  int trials_ = 0;
};

/// Dual averaging (Hoffman & Gelman 2014, eq. 6 with their γ, t₀ and κ) of ln step towards the
/// wanted acceptance; t: iterations of this phase.
void adapt(const Draw& before, int t, double first_step, double wanted, Draw& draw) {
  constexpr double gamma = 0.05, t0 = 10.0, kappa = 0.75;
  const double mean = t > 1 ? before.adaptation[1] : 0.0, last = t > 1 ? before.adaptation[2] : 0.0;
  const double share = 1.0 / (t + t0);
  const double lack = (1.0 - share) * last + share * (wanted - draw.accept);
  const double log_step = std::log(10.0 * first_step) - std::sqrt(t) / gamma * lack;
  const double weight = std::pow(t, -kappa);
  draw.adaptation = {log_step, weight * log_step + (1.0 - weight) * mean, lack};
}

/// The chain's own beginning: twice as far from the mode as draws are, and nearer by halves as long
/// as the path breaks off.
Draw beginning(const Posterior& posterior, const Walk& walk, double first_step, std::uint64_t seed,
               int chain) {
  Draw draw;
  draw.chain = chain;
  draw.w = 2.0 * Random(seed, chain, 0).normal(posterior.size());
  Posterior::Point at;
  for (int halvings = 0; halvings < 30; ++halvings) {
    posterior.evaluate(walk.u(draw.w), false, at);
    draw.log_density = at.log_density;
    if (at.log_density > -infinity) break;
    draw.w *= 0.5;
  }
  draw.adaptation = {std::log(first_step), std::log(first_step), 0.0};
  return draw;
}

}  // namespace

Walk walk_from(const Posterior& posterior, const VectorXd& z) {
  Walk walk;
  walk.mode = mode(posterior, posterior.start(z));
  Posterior::Point at;
  posterior.evaluate(walk.mode, true, at);
  if (!(at.log_density > -infinity))
    throw InputError("posterior",
                     "the best fit is a path that breaks off: there is nothing to "
                     "draw around it");
  const MatrixXd lower = at.curvature.llt().matrixL();
  walk.root = lower.transpose().triangularView<Eigen::Upper>().solve(
      MatrixXd::Identity(posterior.size(), posterior.size()));
  return walk;
}

std::vector<Draw> run_chains(const Posterior& posterior, const Walk& walk,
                             const PosteriorOptions& options, std::uint64_t seed,
                             const std::vector<Draw>& done,
                             const std::function<void(const Draw&)>& after) {
  const int to =
      options.chains_to < 0 ? options.chains : std::min(options.chains_to, options.chains);
  const int last = options.warmup + options.draws;
  const double first_step = std::pow(static_cast<double>(posterior.size()), -0.25);
  std::vector<std::vector<Draw>> chains(static_cast<std::size_t>(options.chains));
  for (const Draw& d : done) chains[static_cast<std::size_t>(d.chain)].push_back(d);
  std::mutex mutex;
  tbb::parallel_for(options.chains_from, to, [&](int chain) {
    std::vector<Draw>& draws = chains[static_cast<std::size_t>(chain)];
    const auto note = [&](Draw draw) {
      draws.push_back(std::move(draw));
      const std::lock_guard lock(mutex);
      if (after) after(draws.back());
    };
    if (draws.empty()) note(beginning(posterior, walk, first_step, seed, chain));
    const Phases phases(options.warmup);
    Metric metric;
    int begin = -1;
    State here;
    while (draws.back().iteration < last && !posterior.problem().interrupted()) {
      const Draw& before = draws.back();
      Draw draw;
      draw.chain = chain;
      draw.iteration = before.iteration + 1;
      draw.adaptation = before.adaptation;
      if (begin != phases.begin(draw.iteration)) {
        begin = phases.begin(draw.iteration);
        metric = metric_of(draws, posterior.size(), begin, phases);
      }
      const bool warming = draw.iteration <= options.warmup;
      const int t = draw.iteration - begin;
      const double step = t == 1 ? first_step : std::exp(before.adaptation[warming ? 0 : 1]);
      Trajectory trajectory(posterior, walk, metric, step, Random(seed, chain, draw.iteration),
                            draw);
      if (here.w.size() == 0) here = trajectory.place(before.w);
      here = trajectory.next(std::move(here));
      draw.w = here.w;
      draw.log_density = here.log_density;
      if (warming) adapt(before, t, first_step, options.accept, draw);
      note(std::move(draw));
    }
  });
  std::vector<Draw> all;
  for (std::vector<Draw>& draws : chains)
    for (Draw& d : draws) all.push_back(std::move(d));
  return all;
}

}  // namespace repose::calibration
