#pragma once
/// \file
/// Viscous forces solved for at the end of the step, for laws whose stress is −pI + 2ηD′
/// (physics.md, MUI-3, NEW). The pressure acts explicitly, and with v* the velocity that it and
/// gravity bring, the nodes' velocity v solves
///   M (v − v*) + Δt Σ V Bᵀ 2η(γ̇(v)) D′(v) = 0
/// among the fields that the walls admit: the minimum of ½|v − v*|²_M + ΔtΣVφ(γ̇), φ′ = τ, which is
/// convex as τ = ηγ̇ grows with γ̇. Newton's method on it (viscous_operator.hpp), each step by
/// conjugate gradients preconditioned with the diagonal of M + ΔtK.
///
/// Tolerance. The left side grows at least as M: where its residual is R, the velocity is off by at
/// most |R| in the norm of M⁻¹. The solve ends where
///   |R|_{M⁻¹} <= tolerance (|v* − u|_M + |v − v*|_M),
/// the velocity that all forces of the step bring together, or at round-off.

#include "mpm/step/viscous_operator.hpp"

namespace repose::mpm {

/// What an implicit solve did, per metre of depth.
struct ViscousEffect {
  bool converged = true;
  double kinetic = 0.0;  ///< change of ½Σmv² by the viscous impulse [J]
  /// −½ΔtΣF·(v − u) [J]: by how much the work of the viscous impulse on the mean velocity of the
  /// step exceeds that on the velocity at its end, which the points sum up.
  double half_jump_work = 0.0;
  double residual = 0.0, allowed = 0.0;  ///< |R|_{M⁻¹} at the end and the bound on it [√J]
  int newton_iterations = 0, cg_iterations = 0;
};

/// Stores −p where the explicit forces read it, and the work of the step with the viscous stress at
/// its end: −½(p_n + p_{n+1}) tr Δε + s_{n+1}:Δε.
void split_stress(PointSet& points, const SlotRange& range, const Batch& batch);

class ImplicitViscosity {
 public:
  /// Brings the nodes' velocities after forces from v* (walls applied) to v.
  ViscousEffect solve(Grid& grid, std::vector<PointSet>& bodies, const Walls& walls, Kernel kernel,
                      double dt, double tolerance, tbb::task_arena& arena);

 private:
  /// Calls f(a node block's index, a node's place in it) for all nodes that may hold mass.
  template <class F>
  void each_node(F&& f);
  /// Sums of f(block, place), an array of numbers, over the nodes in a fixed order.
  template <std::size_t n, class F>
  std::array<double, n> sums(F&& f);
  double dot(const NodeVector& a, const NodeVector& b);
  double residual_norm();  ///< |R|_{M⁻¹}
  void add_inertia(const NodeVector& v, NodeVector& R);
  /// R(v) for v = E y; extends v.
  void residual(NodeVector& v, NodeVector& R);
  /// Largest residual allowed where the velocity has changed by `change` from v* [√J].
  double allowed(double change) const { return tolerance_ * (kick_ + change) + round_off_; }
  /// (M + ΔtK) step = −R, starting from the field `from`, until its residual is `share` of R or
  /// half of what is allowed; false after too many iterations.
  bool newton_step(const NodeVector& from, double share, int& iterations);
  /// Takes as much of the step as brings the potential down.
  void search_along_step();

  tbb::task_arena* arena_ = nullptr;
  ViscousOperator operator_;
  double tolerance_ = 0.0;
  double kick_ = 0.0;       ///< |v* − u|_M
  double round_off_ = 0.0;  ///< of |R|_{M⁻¹}
  NodeVector mass_, inverse_mass_, start_, v_, trial_, R_, trial_R_, step_;
  NodeVector inverse_diagonal_, r_, z_, p_, q_;
  std::vector<std::array<double, 3>> block_sums_;
};

}  // namespace repose::mpm
