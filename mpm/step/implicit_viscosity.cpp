#include "mpm/step/implicit_viscosity.hpp"

#include <cmath>
#include <limits>

#include <fmt/core.h>

#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {
namespace {

constexpr int most_newton_iterations = 100;  // of one step; 1 to 10 in any run so far
constexpr int most_cg_iterations = 5000;     // of one Newton iteration; 10 to 300 so far
constexpr int most_search_steps = 30;

}  // namespace

void split_stress(PointSet& points, const SlotRange& range, const Batch& batch) {
  double* const minus_p = points.data(points.force_stress[0]);
  for (std::size_t k = 0; k < range.count; ++k) {
    const std::size_t s = range.begin + k;
    Sym<double, 4> stress, strain;
    for (int c = 0; c < 4; ++c) {
      stress[c] = points[SXX + static_cast<std::size_t>(c)][s];
      strain[c] = batch.strain[static_cast<std::size_t>(c)][k];
    }
    const double before = minus_p[s];
    minus_p[s] = mean(stress);
    batch.viscous[k] = contract(deviator(stress), strain);
    batch.work[k] = 0.5 * (before + minus_p[s]) * trace(strain) + batch.viscous[k];
  }
}

template <class F>
void ImplicitViscosity::each_node(F&& f) {
  const std::vector<std::size_t>& live = operator_.live();
  for_each_block(*arena_, live.size(), [&](std::size_t l) {
    for (std::size_t n = 0; n < block_nodes; ++n) f(live[l], n);
  });
}

template <std::size_t count, class F>
std::array<double, count> ImplicitViscosity::sums(F&& f) {
  const std::vector<std::size_t>& live = operator_.live();
  block_sums_.resize(live.size());
  for_each_block(*arena_, live.size(), [&](std::size_t l) {
    std::array<double, count> total{};
    for (std::size_t n = 0; n < block_nodes; ++n) {
      const std::array<double, count> part = f(live[l], n);
      for (std::size_t c = 0; c < count; ++c) total[c] += part[c];
    }
    std::copy(total.begin(), total.end(), block_sums_[l].begin());
  });
  std::array<double, count> total{};
  for (const auto& part : block_sums_)
    for (std::size_t c = 0; c < count; ++c) total[c] += part[c];
  return total;
}

double ImplicitViscosity::dot(const NodeVector& a, const NodeVector& b) {
  return sums<1>([&](std::size_t k, std::size_t n) {
    return std::array{a[k].x[n] * b[k].x[n] + a[k].y[n] * b[k].y[n]};
  })[0];
}

double ImplicitViscosity::residual_norm() {
  return std::sqrt(sums<1>([&](std::size_t k, std::size_t n) {
    const NodeField &R = R_[k], &w = inverse_mass_[k];
    return std::array{R.x[n] * R.x[n] * w.x[n] + R.y[n] * R.y[n] * w.y[n]};
  })[0]);
}

void ImplicitViscosity::add_inertia(const NodeVector& v, NodeVector& R) {
  each_node([&](std::size_t k, std::size_t n) {
    R[k].x[n] += mass_[k].x[n] * (v[k].x[n] - start_[k].x[n]);
    R[k].y[n] += mass_[k].y[n] * (v[k].y[n] - start_[k].y[n]);
  });
}

void ImplicitViscosity::residual(NodeVector& v, NodeVector& R) {
  operator_.mirror().extend(v);
  operator_.impulse(v, R);
  add_inertia(v, R);
}

bool ImplicitViscosity::newton_step(const NodeVector& from, double share, int& iterations) {
  operator_.diagonal(inverse_diagonal_);
  const auto inverse = [](double x) { return x > 0.0 ? 1.0 / x : 0.0; };
  const auto first = sums<3>([&](std::size_t k, std::size_t n) {
    NodeField &B = inverse_diagonal_[k], &r = r_[k], &p = p_[k];
    const NodeField &m = mass_[k], &w = inverse_mass_[k];
    B.x[n] += m.x[n];
    B.y[n] += m.y[n];
    const double scale_x = B.x[n] * from[k].x[n], scale_y = B.y[n] * from[k].y[n];
    B.x[n] = inverse(B.x[n]);
    B.y[n] = inverse(B.y[n]);
    step_[k].x[n] = step_[k].y[n] = 0.0;
    r.x[n] = -R_[k].x[n];
    r.y[n] = -R_[k].y[n];
    p.x[n] = B.x[n] * r.x[n];
    p.y[n] = B.y[n] * r.y[n];
    return std::array{r.x[n] * p.x[n] + r.y[n] * p.y[n],
                      r.x[n] * r.x[n] * w.x[n] + r.y[n] * r.y[n] * w.y[n],
                      scale_x * scale_x * w.x[n] + scale_y * scale_y * w.y[n]};
  });
  double rz = first[0];
  // a residual is a sum over the 16 nodes of a stencil of terms as large as the diagonal's
  round_off_ = 16.0 * std::numeric_limits<double>::epsilon() * std::sqrt(first[2]);
  if (first[1] == 0.0) return true;
  const double enough = share * std::sqrt(first[1]);
  for (int it = 0; it < most_cg_iterations; ++it) {
    operator_.mirror().extend(p_);
    operator_.apply(p_, q_);
    ++iterations;
    const double pq = sums<1>([&](std::size_t k, std::size_t n) {
      NodeField& q = q_[k];
      const NodeField &m = mass_[k], &p = p_[k];
      q.x[n] += m.x[n] * p.x[n];
      q.y[n] += m.y[n] * p.y[n];
      return std::array{p.x[n] * q.x[n] + p.y[n] * q.y[n]};
    })[0];
    if (!(pq > 0.0)) return false;  // not a number: the operator is positive
    const double a = rz / pq;
    const auto now = sums<3>([&](std::size_t k, std::size_t n) {
      NodeField &x = step_[k], &r = r_[k], &z = z_[k];
      const NodeField &p = p_[k], &q = q_[k], &B = inverse_diagonal_[k];
      const NodeField &m = mass_[k], &w = inverse_mass_[k];
      x.x[n] += a * p.x[n];
      x.y[n] += a * p.y[n];
      r.x[n] -= a * q.x[n];
      r.y[n] -= a * q.y[n];
      z.x[n] = B.x[n] * r.x[n];
      z.y[n] = B.y[n] * r.y[n];
      const double dx = from[k].x[n] + x.x[n] - start_[k].x[n];
      const double dy = from[k].y[n] + x.y[n] - start_[k].y[n];
      return std::array{r.x[n] * z.x[n] + r.y[n] * z.y[n],
                        r.x[n] * r.x[n] * w.x[n] + r.y[n] * r.y[n] * w.y[n],
                        m.x[n] * dx * dx + m.y[n] * dy * dy};
    });
    if (std::sqrt(now[1]) <= std::max(enough, 0.5 * allowed(std::sqrt(now[2])))) return true;
    const double b = now[0] / rz;
    rz = now[0];
    each_node([&](std::size_t k, std::size_t n) {
      p_[k].x[n] = z_[k].x[n] + b * p_[k].x[n];
      p_[k].y[n] = z_[k].y[n] + b * p_[k].y[n];
    });
  }
  return false;
}

void ImplicitViscosity::search_along_step() {
  // The potential along the step is convex: its slope R·δ is negative at 0 and grows. Take the
  // whole step unless that leads far beyond the minimum; then come back by the secant.
  const double slope_0 = dot(R_, step_);
  double a = 1.0;
  for (int it = 0; it < most_search_steps; ++it) {
    each_node([&](std::size_t k, std::size_t n) {
      trial_[k].x[n] = v_[k].x[n] + a * step_[k].x[n];
      trial_[k].y[n] = v_[k].y[n] + a * step_[k].y[n];
    });
    residual(trial_, trial_R_);
    const double slope = dot(trial_R_, step_);
    if (slope <= 0.5 * std::abs(slope_0)) break;
    a *= std::max(0.1, -slope_0 / (slope - slope_0));
  }
  operator_.take_stress_step(a);
  v_.swap(trial_);
  R_.swap(trial_R_);
}

ViscousEffect ImplicitViscosity::solve(Grid& grid, std::vector<PointSet>& bodies,
                                       const Walls& walls, Kernel kernel, double dt,
                                       double tolerance, tbb::task_arena& arena) {
  arena_ = &arena;
  tolerance_ = tolerance;
  operator_.prepare(grid, bodies, walls, kernel, dt, arena);
  const std::size_t blocks = grid.node_blocks.size();
  for (NodeVector* x : {&mass_, &inverse_mass_, &start_, &v_, &trial_, &R_, &trial_R_, &step_,
                        &inverse_diagonal_, &r_, &z_, &p_, &q_})
    x->assign(blocks, NodeField{});
  each_node([&](std::size_t k, std::size_t n) {
    const NodeBlock& nb = grid.node_blocks[k];
    mass_[k].x[n] = mass_[k].y[n] = nb.mass[n];
    start_[k].x[n] = nb.v[0][n];
    start_[k].y[n] = nb.v[1][n];
    trial_[k].x[n] = nb.u[0][n];
    trial_[k].y[n] = nb.u[1][n];
  });
  operator_.mirror().fold_diagonal(mass_);
  each_node([&](std::size_t k, std::size_t n) {
    inverse_mass_[k].x[n] = mass_[k].x[n] > 0.0 ? 1.0 / mass_[k].x[n] : 0.0;
    inverse_mass_[k].y[n] = mass_[k].y[n] > 0.0 ? 1.0 / mass_[k].y[n] : 0.0;
  });
  const auto distance_from_start = [&](const NodeVector& v) {
    return std::sqrt(sums<1>([&](std::size_t k, std::size_t n) {
      const double x = v[k].x[n] - start_[k].x[n], y = v[k].y[n] - start_[k].y[n];
      return std::array{mass_[k].x[n] * x * x + mass_[k].y[n] * y * y};
    })[0]);
  };
  kick_ = distance_from_start(trial_);

  // A first step from the state of the points, which nearly always is the last one too
  ViscousEffect effect;
  operator_.state_of_points();
  operator_.linearise();
  operator_.linear_impulse(trial_, R_);
  add_inertia(trial_, R_);
  effect.converged = newton_step(trial_, 0.0, effect.cg_iterations);
  effect.newton_iterations = 1;
  each_node([&](std::size_t k, std::size_t n) {
    v_[k].x[n] = trial_[k].x[n] + step_[k].x[n];
    v_[k].y[n] = trial_[k].y[n] + step_[k].y[n];
  });
  residual(v_, R_);
  while (effect.converged) {
    effect.allowed = allowed(distance_from_start(v_));
    effect.residual = residual_norm();
    if (effect.residual <= effect.allowed) break;
    operator_.linearise();
    effect.converged = effect.newton_iterations++ < most_newton_iterations &&
                       newton_step(v_, 0.1, effect.cg_iterations);
    operator_.mirror().extend(step_);
    operator_.step_stress(step_);
    search_along_step();
  }

  if (!effect.converged) {
    effect.allowed = allowed(distance_from_start(v_));
    effect.residual = residual_norm();
  }

  const auto work = sums<2>([&](std::size_t k, std::size_t n) {
    const NodeBlock& nb = grid.node_blocks[k];
    const double vx = v_[k].x[n], vy = v_[k].y[n];
    const double px = mass_[k].x[n] * (vx - nb.v[0][n]), py = mass_[k].y[n] * (vy - nb.v[1][n]);
    return std::array{0.5 * (px * (vx + nb.v[0][n]) + py * (vy + nb.v[1][n])),
                      -0.5 * (px * (vx - nb.u[0][n]) + py * (vy - nb.u[1][n]))};
  });
  effect.kinetic = work[0];
  effect.half_jump_work = work[1];
  operator_.mirror().extend(v_);
  each_node([&](std::size_t k, std::size_t n) {
    grid.node_blocks[k].v[0][n] = v_[k].x[n];
    grid.node_blocks[k].v[1][n] = v_[k].y[n];
  });
  return effect;
}

template <>
void Simulation::Impl<2>::solve_viscosity(double dt) {
  viscous_effect_ = {};
  if (scene.viscosity != Viscosity::implicit_solve) return;
  viscous_effect_ =
      viscosity_.solve(grid, bodies, walls, scene.kernel, dt, scene.viscosity_tolerance, arena);
  newton_iterations += viscous_effect_.newton_iterations;
  cg_iterations += viscous_effect_.cg_iterations;
  if (!viscous_effect_.converged)
    throw NumericalFailure(fmt::format(
        "step {} at t = {:.6g} s: the implicit viscosity is still off by {:.3g} after {} Newton "
        "and "
        "{} conjugate gradient iterations ({:.3g} allowed, of the norm of the step's velocity "
        "change); try a smaller courant or a larger step.viscosity_tolerance (solver)",
        steps, time, viscous_effect_.residual, viscous_effect_.newton_iterations,
        viscous_effect_.cg_iterations, viscous_effect_.allowed));
}

}  // namespace repose::mpm
