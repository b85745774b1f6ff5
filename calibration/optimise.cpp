#include "calibration/optimise.hpp"

#include <chrono>
#include <cmath>
#include <stdexcept>

#include <nlopt.hpp>

namespace repose::calibration {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

struct Entry {
  Algorithm about;
  nlopt::algorithm code;
};

// NEWUOA (without bounds) and AUGLAG (for constraints, which a fit has none of) are left out, and
// so is NEWUOA_BOUND: BOBYQA is its successor, and the inner loop of its trust region, within
// NLopt, need not end and cannot be interrupted (seen on five parameters of Cam-Clay).
constexpr std::array entries{
    Entry{{levenberg_marquardt_name, false, true, "damped Gauss-Newton on the residual vector"},
          nlopt::NUM_ALGORITHMS},
    Entry{{"GN_CRS2_LM", true, false, "controlled random search with local mutation"},
          nlopt::GN_CRS2_LM},
    Entry{{"GN_ISRES", true, false, "evolution strategy"}, nlopt::GN_ISRES},
    Entry{{"GN_ESCH", true, false, "evolutionary algorithm"}, nlopt::GN_ESCH},
    Entry{{"GN_DIRECT", true, false, "dividing rectangles"}, nlopt::GN_DIRECT},
    Entry{{"GN_DIRECT_L", true, false, "dividing rectangles, locally biased"}, nlopt::GN_DIRECT_L},
    Entry{{"GN_DIRECT_L_RAND", true, false, "the same with random choices"},
          nlopt::GN_DIRECT_L_RAND},
    Entry{{"GN_ORIG_DIRECT", true, false, "Gablonsky's DIRECT"}, nlopt::GN_ORIG_DIRECT},
    Entry{{"GN_ORIG_DIRECT_L", true, false, "Gablonsky's DIRECT-L"}, nlopt::GN_ORIG_DIRECT_L},
    Entry{{"GN_AGS", true, false, "space-filling curve"}, nlopt::GN_AGS},
    Entry{{"G_MLSL", true, false, "multi-level single linkage around the local algorithm"},
          nlopt::G_MLSL},
    Entry{{"G_MLSL_LDS", true, false, "the same from low-discrepancy points"}, nlopt::G_MLSL_LDS},
    Entry{{"GD_STOGO", true, true, "branch and bound with gradients"}, nlopt::GD_STOGO},
    Entry{{"GD_STOGO_RAND", true, true, "the same, randomised"}, nlopt::GD_STOGO_RAND},
    Entry{{"LD_SLSQP", false, true, "sequential quadratic programming"}, nlopt::LD_SLSQP},
    Entry{{"LD_LBFGS", false, true, "limited-memory BFGS"}, nlopt::LD_LBFGS},
    Entry{{"LD_MMA", false, true, "method of moving asymptotes"}, nlopt::LD_MMA},
    Entry{{"LD_CCSAQ", false, true, "conservative convex separable approximation"},
          nlopt::LD_CCSAQ},
    Entry{{"LD_VAR1", false, true, "variable metric, rank 1"}, nlopt::LD_VAR1},
    Entry{{"LD_VAR2", false, true, "variable metric, rank 2"}, nlopt::LD_VAR2},
    Entry{{"LD_TNEWTON", false, true, "truncated Newton"}, nlopt::LD_TNEWTON},
    Entry{{"LD_TNEWTON_RESTART", false, true, "truncated Newton, restarted"},
          nlopt::LD_TNEWTON_RESTART},
    Entry{{"LD_TNEWTON_PRECOND", false, true, "truncated Newton, preconditioned"},
          nlopt::LD_TNEWTON_PRECOND},
    Entry{{"LD_TNEWTON_PRECOND_RESTART", false, true, "both"}, nlopt::LD_TNEWTON_PRECOND_RESTART},
    Entry{{"LN_BOBYQA", false, false, "quadratic models within bounds"}, nlopt::LN_BOBYQA},
    Entry{{"LN_COBYLA", false, false, "linear models"}, nlopt::LN_COBYLA},
    Entry{{"LN_NELDERMEAD", false, false, "simplex within bounds"}, nlopt::LN_NELDERMEAD},
    Entry{{"LN_SBPLX", false, false, "simplex on subspaces"}, nlopt::LN_SBPLX},
    Entry{{"LN_PRAXIS", false, false, "principal axes"}, nlopt::LN_PRAXIS},
};

constexpr auto abouts = [] {
  std::array<Algorithm, entries.size()> list{};
  for (std::size_t i = 0; i < entries.size(); ++i) list[i] = entries[i].about;
  return list;
}();

const Entry& entry_of(std::string_view name) {
  for (const Entry& e : entries)
    if (e.about.name == name) return e;
  throw std::invalid_argument("no algorithm is called " + std::string(name));
}

/// The objective as NLopt calls it. ½ rᵀr per residual: some algorithms mind large numbers.
class Objective {
 public:
  Objective(const Problem& problem, const OptimiseOptions& options, Optimum& best)
      : problem_(problem),
        options_(options),
        best_(best) {}

  static double call(const std::vector<double>& x, std::vector<double>& gradient, void* self) {
    return static_cast<Objective*>(self)->operator()(x, gradient);
  }
  void stops(nlopt::opt& opt) { opt_ = &opt; }
  bool interrupted() const { return interrupted_; }
  bool spent() const { return spent_; }
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  double operator()(const std::vector<double>& x, std::vector<double>& gradient) {
    const VectorXd z = Eigen::Map<const VectorXd>(x.data(), static_cast<Index>(x.size()));
    const auto per_row = 1.0 / static_cast<double>(problem_.size());
    const bool spent = best_.evaluations + best_.gradients >= options_.max_evaluations;
    if (spent || problem_.interrupted()) {
      // the count is ours: algorithms inside MLSL and some others overrun NLopt's own
      spent_ = spent_ || spent;
      interrupted_ = interrupted_ || !spent;
      opt_->force_stop();
      std::fill(gradient.begin(), gradient.end(), 0.0);
      return std::isfinite(best_.objective) ? best_.objective * per_row : 1e300;
    }
    if (!z.allFinite()) {  // an algorithm that has gone astray is told so by a bad value
      std::fill(gradient.begin(), gradient.end(), 0.0);
      return 1e300;
    }
    problem_.evaluate(z, !gradient.empty(), now_);
    ++(gradient.empty() ? best_.evaluations : best_.gradients);
    const double f = now_.objective();
    if (!gradient.empty()) {
      Eigen::Map<VectorXd> g(gradient.data(), static_cast<Index>(gradient.size()));
      g = per_row * (now_.J.transpose() * now_.r);
    }
    if (f < best_.objective) {
      best_.objective = f;
      best_.z = clipped(z);
      best_.failed = now_.failed;
      best_.trace.push_back({best_.evaluations, best_.gradients, seconds(), f});
    }
    return f * per_row;
  }

  const Problem& problem_;
  const OptimiseOptions& options_;
  Optimum& best_;
  Evaluation now_;
  nlopt::opt* opt_ = nullptr;
  bool interrupted_ = false, spent_ = false;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

void tolerances(nlopt::opt& opt, const OptimiseOptions& options) {
  opt.set_lower_bounds(0.0);
  opt.set_upper_bounds(1.0);
  opt.set_xtol_abs(options.x_tolerance);
  opt.set_ftol_rel(options.f_tolerance);
}

}  // namespace

std::span<const Algorithm> algorithms() { return abouts; }

const Algorithm* find_algorithm(std::string_view name) {
  for (const Algorithm& a : abouts)
    if (a.name == name) return &a;
  return nullptr;
}

Optimum optimise(const Problem& problem, std::string_view algorithm, const VectorXd& start,
                 const OptimiseOptions& options) {
  const Entry& entry = entry_of(algorithm);
  if (entry.code == nlopt::NUM_ALGORITHMS) return levenberg_marquardt(problem, start, options);
  Optimum best;
  best.z = clipped(start);
  best.objective = std::numeric_limits<double>::infinity();
  Objective objective(problem, options, best);
  const auto n = static_cast<unsigned>(problem.parameters());
  try {
    nlopt::srand(static_cast<unsigned long>(options.seed));
    nlopt::opt opt(entry.code, n);
    tolerances(opt, options);
    opt.set_min_objective(&Objective::call, &objective);
    opt.set_maxeval(static_cast<int>(std::min(options.max_evaluations, 2000000000L)));
    if (entry.code == nlopt::G_MLSL || entry.code == nlopt::G_MLSL_LDS) {
      const Entry& inner = entry_of(options.inner);
      const bool usable = inner.code != nlopt::NUM_ALGORITHMS && !inner.about.global;
      nlopt::opt local(usable ? inner.code : nlopt::LD_SLSQP, n);
      tolerances(local, options);
      local.set_ftol_rel(1e-8);
      local.set_maxeval(200);
      opt.set_local_optimizer(local);
    }
    if (!entry.about.global && !entry.about.gradient) opt.set_initial_step(0.1);
    objective.stops(opt);
    std::vector<double> x(best.z.data(), best.z.data() + best.z.size());
    double f = 0.0;
    const nlopt::result result = opt.optimize(x, f);
    best.why = result == nlopt::MAXEVAL_REACHED || objective.spent() ? "evaluations" : "converged";
    if (objective.interrupted()) best.why = "interrupted";  // some do not tell a forced stop
  } catch (const nlopt::roundoff_limited&) {
    best.why = "round-off";
  } catch (const nlopt::forced_stop&) {
    best.why = objective.interrupted() ? "interrupted" : "evaluations";
  } catch (const std::exception& error) {
    best.why = std::string("error: ") + error.what();
  }
  // whatever the algorithm returned, the best point that was seen counts, evaluated afresh
  Evaluation check;
  problem.evaluate(best.z, false, check);
  best.objective = check.objective();
  best.failed = check.failed;
  best.seconds = objective.seconds();
  best.trace.push_back({best.evaluations, best.gradients, best.seconds, best.objective});
  return best;
}

}  // namespace repose::calibration
