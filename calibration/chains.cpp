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

/// A place with its momentum.
struct State {
  VectorXd w, p, gradient;
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
  Trajectory(const Posterior& posterior, const Walk& walk, double step, Random random, Draw& draw)
      : posterior_(posterior),
        walk_(walk),
        step_(step),
        random_(std::move(random)),
        draw_(draw) {}

  State place(const VectorXd& w) const {
    Posterior::Point at;
    posterior_.evaluate(walk_.u(w), false, at);
    return {w, {}, walk_.root.transpose() * at.gradient, at.log_density};
  }

  /// From a place to the next; counts into the draw.
  State next(State from) {
    from.p = random_.normal(from.w.size());
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
  static double energy(const State& s) { return 0.5 * s.p.squaredNorm() - s.log_density; }

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
    State to = place(from.w + step * half);
    to.p = half + 0.5 * step * to.gradient;
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
    const VectorXd inner = forwards ? more.left.p : more.right.p;
    const VectorXd outer = forwards ? tree.right.p : tree.left.p;
    const VectorXd before = tree.momentum;
    tree.momentum += more.momentum;
    tree.log_weight = log_sum(tree.log_weight, more.log_weight);
    // neither the whole, nor one half with the first of the other, has turned
    const VectorXd& first = forwards ? tree.left.p : tree.right.p;
    const VectorXd last = forwards ? more.right.p : more.left.p;
    tree.goes_on = apart(tree.momentum, first, last) && apart(before + inner, first, inner) &&
                   apart(more.momentum + outer, outer, last);
    (forwards ? tree.right : tree.left) = std::move(forwards ? more.right : more.left);
  }
  static bool apart(const VectorXd& momentum, const VectorXd& first, const VectorXd& last) {
    return momentum.dot(first) > 0.0 && momentum.dot(last) > 0.0;
  }

  const Posterior& posterior_;
  const Walk& walk_;
  double step_;
  Random random_;
  Draw& draw_;
  double start_energy_ = 0.0, accepted_ = 0.0;
  int trials_ = 0;
};

/// Dual averaging (Hoffman & Gelman 2014, eq. 6 with their γ, t₀ and κ) of ln step towards the
/// wanted acceptance.
void adapt(const Draw& before, double first_step, double wanted, Draw& draw) {
  constexpr double gamma = 0.05, t0 = 10.0, kappa = 0.75;
  const double t = draw.iteration, share = 1.0 / (t + t0);
  const double lack = (1.0 - share) * before.adaptation[2] + share * (wanted - draw.accept);
  const double log_step = std::log(10.0 * first_step) - std::sqrt(t) / gamma * lack;
  const double weight = std::pow(t, -kappa);
  draw.adaptation = {log_step, weight * log_step + (1.0 - weight) * before.adaptation[1], lack};
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
    State here;
    while (draws.back().iteration < last && !posterior.problem().interrupted()) {
      const Draw& before = draws.back();
      Draw draw;
      draw.chain = chain;
      draw.iteration = before.iteration + 1;
      draw.adaptation = before.adaptation;
      const bool warming = draw.iteration <= options.warmup;
      Trajectory trajectory(posterior, walk, std::exp(before.adaptation[warming ? 0 : 1]),
                            Random(seed, chain, draw.iteration), draw);
      if (here.w.size() == 0) here = trajectory.place(before.w);
      here = trajectory.next(std::move(here));
      draw.w = here.w;
      draw.log_density = here.log_density;
      if (warming) adapt(before, first_step, options.accept, draw);
      note(std::move(draw));
    }
  });
  std::vector<Draw> all;
  for (std::vector<Draw>& draws : chains)
    for (Draw& d : draws) all.push_back(std::move(d));
  return all;
}

}  // namespace repose::calibration
