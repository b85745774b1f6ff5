#include "mpm/implicit_viscosity.hpp"

#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "mpm/simulation_impl.hpp"

namespace repose::mpm {
namespace {

constexpr int most_newton_iterations = 200;
constexpr int most_cg_iterations = 5000;  // of one Newton step

/// Calls f(block, component index, entry) for both components of all nodes of block k.
template <class F>
void each_entry(F&& f) {
  for (std::size_t n = 0; n < block_nodes; ++n) f(n);
}

}  // namespace

void split_stress(PointSet& points, const Range& range, const Batch& batch) {
  double* const minus_p = points[points.force_stress[0]];
  for (std::size_t k = 0; k < range.count; ++k) {
    const std::size_t s = range.begin + k;
    Sym<double, 4> stress, strain;
    for (int c = 0; c < 4; ++c) {
      stress[c] = points[SXX + static_cast<std::size_t>(c)][s];
      strain[c] = batch.strain[static_cast<std::size_t>(c)][k];
    }
    const double before = minus_p[s];
    minus_p[s] = mean(stress);
    batch.work[k] =
        0.5 * (before + minus_p[s]) * trace(strain) + contract(deviator(stress), strain);
  }
}

template <class F>
double ImplicitViscosity::sum(F&& f) {
  block_sums_.resize(v_.size());
  for_each_block(*arena_, v_.size(), [&](std::size_t k) {
    double total = 0.0;
    for (std::size_t n = 0; n < block_nodes; ++n) total += f(k, n);
    block_sums_[k] = total;
  });
  double total = 0.0;
  for (const double part : block_sums_) total += part;
  return total;
}

double ImplicitViscosity::dot(const NodeVector& a, const NodeVector& b) {
  return sum([&](std::size_t k, std::size_t n) {
    return a[k].x[n] * b[k].x[n] + a[k].y[n] * b[k].y[n];
  });
}

double ImplicitViscosity::residual_norm(const NodeVector& R) {
  return std::sqrt(sum([&](std::size_t k, std::size_t n) {
    return R[k].x[n] * R[k].x[n] * inverse_mass_[k].x[n] +
           R[k].y[n] * R[k].y[n] * inverse_mass_[k].y[n];
  }));
}

void ImplicitViscosity::residual(ViscousOperator& op, NodeVector& v, NodeVector& R) {
  op.mirror().extend(v);
  op.impulse(v, R);
  for_each_block(*arena_, v.size(), [&](std::size_t k) {
    for (std::size_t n = 0; n < block_nodes; ++n) {
      R[k].x[n] += mass_[k].x[n] * (v[k].x[n] - start_[k].x[n]);
      R[k].y[n] += mass_[k].y[n] * (v[k].y[n] - start_[k].y[n]);
    }
  });
}

bool ImplicitViscosity::newton_step(ViscousOperator& op, double wanted, int& iterations) {
  op.diagonal(inverse_diagonal_);
  const auto inverse = [](double x) { return x > 0.0 ? 1.0 / x : 0.0; };
  const double rz_start = [&] {
    return sum([&](std::size_t k, std::size_t n) {
      NodeField& B = inverse_diagonal_[k];
      B.x[n] = inverse(B.x[n] + mass_[k].x[n]);
      B.y[n] = inverse(B.y[n] + mass_[k].y[n]);
      step_[k].x[n] = step_[k].y[n] = 0.0;
      r_[k].x[n] = -R_[k].x[n];
      r_[k].y[n] = -R_[k].y[n];
      p_[k].x[n] = B.x[n] * r_[k].x[n];
      p_[k].y[n] = B.y[n] * r_[k].y[n];
      return r_[k].x[n] * p_[k].x[n] + r_[k].y[n] * p_[k].y[n];
    });
  }();
  double rz = rz_start;
  for (int it = 0; it < most_cg_iterations; ++it) {
    op.mirror().extend(p_);
    op.apply(p_, q_);
    ++iterations;
    const double pq = sum([&](std::size_t k, std::size_t n) {
      q_[k].x[n] += mass_[k].x[n] * p_[k].x[n];
      q_[k].y[n] += mass_[k].y[n] * p_[k].y[n];
      return p_[k].x[n] * q_[k].x[n] + p_[k].y[n] * q_[k].y[n];
    });
    if (!(pq > 0.0)) return rz == 0.0;
    const double a = rz / pq;
    const double rz_new = sum([&](std::size_t k, std::size_t n) {
      step_[k].x[n] += a * p_[k].x[n];
      step_[k].y[n] += a * p_[k].y[n];
      r_[k].x[n] -= a * q_[k].x[n];
      r_[k].y[n] -= a * q_[k].y[n];
      z_[k].x[n] = inverse_diagonal_[k].x[n] * r_[k].x[n];
      z_[k].y[n] = inverse_diagonal_[k].y[n] * r_[k].y[n];
      return r_[k].x[n] * z_[k].x[n] + r_[k].y[n] * z_[k].y[n];
    });
    if (!(residual_norm(r_) > wanted)) return true;
    const double b = rz_new / rz;
    rz = rz_new;
    for_each_block(*arena_, p_.size(), [&](std::size_t k) {
      for (std::size_t n = 0; n < block_nodes; ++n) {
        p_[k].x[n] = z_[k].x[n] + b * p_[k].x[n];
        p_[k].y[n] = z_[k].y[n] + b * p_[k].y[n];
      }
    });
  }
  return false;
}

ViscousEffect ImplicitViscosity::solve(Grid& grid, std::vector<PointSet>& bodies,
                                       const Walls& walls, Kernel kernel, double dt,
                                       double tolerance, tbb::task_arena& arena) {
  arena_ = &arena;
  ViscousOperator& op = operator_;
  op.prepare(grid, bodies, walls, kernel, dt, arena);
  const std::size_t blocks = grid.node_blocks.size();
  for (NodeVector* x : {&mass_, &inverse_mass_, &start_, &v_, &trial_, &R_, &trial_R_, &step_,
                        &inverse_diagonal_, &r_, &z_, &p_, &q_})
    x->resize(blocks);
  for (std::size_t k = 0; k < blocks; ++k) {
    const NodeBlock& nb = grid.node_blocks[k];
    mass_[k] = {nb.mass, nb.mass};
    start_[k] = v_[k] = {nb.vx, nb.vy};
    trial_[k] = {nb.ux, nb.uy};
  }
  op.mirror().fold_diagonal(mass_);
  const auto norm_M = [&](const NodeVector& a, const NodeVector& b) {
    return std::sqrt(sum([&](std::size_t k, std::size_t n) {
      const double x = a[k].x[n] - b[k].x[n], y = a[k].y[n] - b[k].y[n];
      return mass_[k].x[n] * x * x + mass_[k].y[n] * y * y;
    }));
  };
  for (std::size_t k = 0; k < blocks; ++k)
    for (std::size_t n = 0; n < block_nodes; ++n) {
      inverse_mass_[k].x[n] = mass_[k].x[n] > 0.0 ? 1.0 / mass_[k].x[n] : 0.0;
      inverse_mass_[k].y[n] = mass_[k].y[n] > 0.0 ? 1.0 / mass_[k].y[n] : 0.0;
    }

  ViscousEffect effect;
  const double explicit_kick = norm_M(start_, trial_);
  // begin with v* or with u, whichever is closer to balance
  residual(op, trial_, trial_R_);
  residual(op, v_, R_);
  double R = residual_norm(R_);
  if (const double R_u = residual_norm(trial_R_); R_u < R) {
    v_.swap(trial_);
    residual(op, v_, R_);
    R = R_u;
  }
  static const bool trace = std::getenv("REPOSE_TRACE") != nullptr;
  static const bool picard = std::getenv("REPOSE_PICARD") != nullptr;
  for (;;) {
    effect.allowed = tolerance * (explicit_kick + norm_M(v_, start_));
    effect.residual = R;
    if (trace) fmt::print("  {} R {:.3e} allowed {:.3e} cg {}\n", effect.newton_iterations, R, effect.allowed, effect.cg_iterations);
    if (R <= effect.allowed) break;
    if (effect.newton_iterations == most_newton_iterations) {
      effect.converged = false;
      break;
    }
    ++effect.newton_iterations;
    op.linearise(picard);
    if (!newton_step(op, std::max(0.5 * effect.allowed, 0.1 * R), effect.cg_iterations)) {
      effect.converged = false;
      break;
    }
    op.mirror().extend(step_);
    op.step_stress(step_);
    // The potential along the step is convex: its slope R·δ is negative at 0 and grows. Take the
    // whole step unless it leads beyond the minimum by more than it began before it.
    const double slope_0 = dot(R_, step_);
    double low = 0.0, high = 1.0, a = 1.0, slope_low = slope_0;
    for (int it = 0; it < 30; ++it) {
      for_each_block(*arena_, blocks, [&](std::size_t k) {
        for (std::size_t n = 0; n < block_nodes; ++n) {
          trial_[k].x[n] = v_[k].x[n] + a * step_[k].x[n];
          trial_[k].y[n] = v_[k].y[n] + a * step_[k].y[n];
        }
      });
      residual(op, trial_, trial_R_);
      const double slope = dot(trial_R_, step_);
      if (trace) fmt::print("     a {:.3e} slope {:.3e} of {:.3e} R {:.3e}\n", a, slope, slope_0, residual_norm(trial_R_));
      if (slope <= 0.5 * std::abs(slope_0)) {
        if (slope >= 0.9 * slope_0 || true) break;
      }
      high = a;
      a = std::max(low + 0.1 * (high - low), low + (high - low) * (-slope_low) / (slope - slope_low));
    }
    op.take_stress_step(a);
    v_.swap(trial_);
    R_.swap(trial_R_);
    R = residual_norm(R_);
  }

  effect.kinetic = sum([&](std::size_t k, std::size_t n) {
    const NodeBlock& nb = grid.node_blocks[k];
    return 0.5 * (mass_[k].x[n] * (v_[k].x[n] * v_[k].x[n] - nb.vx[n] * nb.vx[n]) +
                  mass_[k].y[n] * (v_[k].y[n] * v_[k].y[n] - nb.vy[n] * nb.vy[n]));
  });
  effect.half_jump_work = -0.5 * sum([&](std::size_t k, std::size_t n) {
    const NodeBlock& nb = grid.node_blocks[k];
    return mass_[k].x[n] * (v_[k].x[n] - nb.vx[n]) * (v_[k].x[n] - nb.ux[n]) +
           mass_[k].y[n] * (v_[k].y[n] - nb.vy[n]) * (v_[k].y[n] - nb.uy[n]);
  });
  op.mirror().extend(v_);
  for (std::size_t k = 0; k < blocks; ++k) {
    grid.node_blocks[k].vx = v_[k].x;
    grid.node_blocks[k].vy = v_[k].y;
  }
  return effect;
}

void Simulation::Impl::solve_viscosity(double dt) {
  viscous_effect_ = {};
  if (scene.viscosity != Viscosity::implicit_solve) return;
  viscous_effect_ = viscosity_.solve(grid, bodies, walls, scene.kernel, dt,
                                     scene.viscosity_tolerance, arena);
  newton_iterations += viscous_effect_.newton_iterations;
  cg_iterations += viscous_effect_.cg_iterations;
  if (!viscous_effect_.converged)
    throw NumericalFailure(fmt::format(
        "step {} at t = {:.6g} s: the implicit viscosity is still off by {:.3g} after {} Newton and "
        "{} conjugate gradient iterations ({:.3g} allowed, of the norm of the step's velocity "
        "change); try a smaller courant or a larger step.viscosity_tolerance (solver)",
        steps, time, viscous_effect_.residual, viscous_effect_.newton_iterations,
        viscous_effect_.cg_iterations, viscous_effect_.allowed));
}

}  // namespace repose::mpm
