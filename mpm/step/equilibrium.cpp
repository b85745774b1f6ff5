#include "mpm/step/equilibrium.hpp"

#include <cmath>

#include "models/cone.hpp"
#include "mpm/grid/block_loops.hpp"
#include "mpm/grid/tile_exchange.hpp"
#include "mpm/scene/fill.hpp"
#include "mpm/step/choose_kernel.hpp"
#include "mpm/step/simulation_impl.hpp"

namespace repose::mpm {
namespace {

constexpr int most_rounds = 200;
constexpr int patience = 10;  ///< rounds in which the residual must fall to 0.9 of itself
constexpr int products_of_patience = 200;  ///< and products, within a round

/// Friction of a law at rest, as the largest q/p of triaxial compression; 0: it has none.
struct Strength {
  double M = 0.0, p_shift = 0.0, shape = 0.0;
  explicit Strength(const Material& material) {
    const auto parameters = material.law().parameters;
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      const double x = material.theta()[k];
      if (parameters[k].name == "M") M = x;
      if (parameters[k].name == "mu_0" && material.law().has_stress_memory) M = std::sqrt(3.0) * x;
      if (parameters[k].name == "p_shift") p_shift = x;
      if (parameters[k].name == "shape") shape = x;
    }
  }
  /// q over the largest that a stress can have; 0 where there is no limit.
  double used(const Sym<double, 6>& stress) const {
    if (!(M > 0.0)) return 0.0;
    const Sym<double, 6> s = deviator(stress);
    const double most = M * cone::share(shape, M, s) * (pressure(stress) + p_shift);
    return most > 0.0 ? std::sqrt(3.0) * shear_norm(s) / most : HUGE_VAL;
  }
};

/// f(k, i, j): the k-th stress that forces come from, σ_ij.
template <int dim, class F>
void each_stress(F&& f) {
  if constexpr (dim == 2) {
    f(0, 0, 0);
    f(1, 1, 1);
    f(2, 0, 1);
  } else {
    f(0, 0, 0);
    f(1, 1, 1);
    f(2, 2, 2);
    f(3, 0, 1);
    f(4, 1, 2);
    f(5, 2, 0);
  }
}

template <int dim, class Impl>
class EquilibriumSearch {
  using At = Layout<dim>;
  using NodeValues = std::vector<std::array<typename NodeBlockOf<dim>::Nodes, dim>>;
  static constexpr std::size_t stresses = PointsOf<dim>::force_components;
  /// By body, component and slot.
  using PointValues = std::vector<std::array<std::vector<double>, stresses>>;

 public:
  explicit EquilibriumSearch(Impl& simulation)
      : s_(simulation),
        given_(simulation.bodies),
        gravity_(simulation.gravity),
        scene_(simulation.scene),
        walls_(simulation.walls),
        contact_(surfaces_that_stick(rigid_surfaces(simulation.scene))) {
    for (Wall* wall :
         {&walls_.left, &walls_.right, &walls_.floor, &walls_.top, &walls_.near, &walls_.far}) {
      if (wall->kind == Wall::Kind::friction) wall->kind = Wall::Kind::no_slip;
      wall->speed = 0.0;
    }
    for (std::size_t b = 0; b < s_.bodies.size(); ++b) take(b);
  }

  Equilibrium run() {
    Equilibrium result;
    result.sought = true;
    NodeValues b = accelerations();
    result.guess = result.residual = share_of_weight(b);
    double best = HUGE_VAL;
    int since_best = 0;
    while (result.residual > 0.1 * Equilibrium::exact && result.rounds < most_rounds) {
      correct(b, result.products);
      result.limited = admit();
      ++result.rounds;
      b = accelerations();
      result.residual = share_of_weight(b);
      if (result.residual < 0.9 * best) {
        best = result.residual;
        since_best = 0;
      } else if (++since_best >= patience) {
        break;
      }
    }
    result.in_step = as_the_step_does();
    give_back();
    return result;
  }

 private:
  static std::vector<Surface> surfaces_that_stick(std::vector<Surface> surfaces) {
    for (Surface& surface : surfaces) {
      if (surface.contact == Surface::Contact::friction)
        surface.contact = Surface::Contact::no_slip;
      surface.velocity = {};
      surface.spin = 0.0;
    }
    return surfaces;
  }

  /// Points of a body in double precision and at rest, and what is known of them.
  void take(std::size_t b) {
    PointsOf<dim>& points = s_.bodies[b];
    const PointsOf<dim>& given = given_[b];
    points.single = false;
    for (std::size_t f = 0; f < points.fields; ++f) points.assign(f, given.values(f));
    for (std::size_t k = 0; k < dim; ++k) std::fill_n(points.data(At::v + k), points.slots(), 0.0);
    for (std::size_t k = 0; k < At::gradient; ++k)
      for (const std::size_t f : {At::L + k, points.affine + k})
        std::fill_n(points.data(f), points.slots(), 0.0);
    Stress& stress = stress_.emplace_back(points.slots());
    std::vector<double>& scale = scale_.emplace_back(points.slots(), 0.0);
    std::vector<double>& least = least_pressure_.emplace_back(points.slots(), 0.0);
    std::vector<double>& most = most_used_.emplace_back(points.slots(), 1.0);
    const Strength strength(*points.material);
    fluid_.push_back(!points.material->law().has_stress_memory);
    root_.emplace_back(fluid_.back(), s_.scene.bodies[b].initial.K0.value_or(1.0));
    for (std::size_t s = 0; s < points.slots(); ++s) {
      Sym<double, 6>& at = stress[s];
      for (std::size_t k = 0; k < At::components; ++k) at.c[k] = points[At::stress + k][s];
      if (points.id[s] < 0 || !s_.scene.bodies[b].lithostatic) continue;
      const double volume = points[At::mass][s] / points[At::rho][s];
      // a quarter of a spacing at least, or the topmost points had nothing to give
      const double floor = 0.25 * points[At::rho][s] * s_.scene.gravity * point_spacing(s_.scene);
      scale[s] = std::max(-at[1], floor) / std::sqrt(volume);
      least[s] = 1e-3 * std::max(pressure(at), floor);
      most[s] = std::max(1.0, strength.used(at));
    }
  }

  /// The fields that forces come from ← f(body, component, slot).
  template <class F>
  void put_stress(F&& f) {
    for (std::size_t b = 0; b < s_.bodies.size(); ++b) {
      PointsOf<dim>& points = s_.bodies[b];
      for (std::size_t k = 0; k < stresses; ++k) {
        double* const to = points.data(points.force_stress[k]);
        for (std::size_t s = 0; s < points.slots(); ++s) to[s] = f(b, k, s);
      }
    }
  }
  static int component(std::size_t k) { return dim == 2 && k == 2 ? 3 : static_cast<int>(k); }

  /// √M T M⁻¹ of the forces that are there, in a unit of time.
  NodeValues weighted_velocities() {
    s_.points_to_grid();
    s_.update_grid(1.0);
    if constexpr (dim == 2)
      if (walls_.periodic()) join_periodic_edges(s_.grid);
    double work = 0.0;
    contact_.apply(s_.grid, 0.0, !std::exchange(connected_, true), s_.arena, work);
    apply_walls(s_.grid, walls_, &mirrored_);
    return weighted();
  }
  NodeValues weighted() const {
    NodeValues z(s_.grid.node_blocks.size());
    for (std::size_t k = 0; k < z.size(); ++k) {
      const NodeBlockOf<dim>& nb = s_.grid.node_blocks[k];
      for (std::size_t n = 0; n < nb.mass.size(); ++n)
        for (std::size_t i = 0; i < dim; ++i) z[k][i][n] = std::sqrt(nb.mass[n]) * nb.v[i][n];
    }
    return z;
  }

  /// Of the stresses as they stand.
  NodeValues accelerations() {
    s_.gravity = gravity_;
    s_.scene.water_table = scene_.water_table;
    put_stress(
        [&](std::size_t b, std::size_t k, std::size_t s) { return stress_[b][s][component(k)]; });
    return weighted_velocities();
  }

  double share_of_weight(const NodeValues& z) const {
    double mass = 0.0;
    for (const PointsOf<dim>& points : s_.bodies)
      for (std::size_t s = 0; s < points.slots(); ++s)
        if (points.id[s] >= 0) mass += points[At::mass][s];
    return norm(z) / (s_.scene.gravity * std::sqrt(mass));
  }

  /// The root of an isotropic stiffness, y_ii → c (α y_ii + β Σ y_jj), y_ij → c α y_ij/√2.
  struct Root {
    double alpha = 1.0, beta = 0.0, nu = 0.0;
    /// A fluid bears a pressure only. Else ν = K0/(1 + K0), up to 0.45: a column that is compressed
    /// keeps its K0.
    Root(bool fluid, double K0) {
      if (fluid) {
        alpha = 0.0;
        beta = 1.0 / dim;
        return;
      }
      nu = std::min(K0 / (1.0 + K0), 0.45);
      beta = (std::sqrt(1.0 + dim * nu / (1.0 - 2.0 * nu)) - 1.0) / dim;
    }
  };
  double rooted(std::size_t b, std::size_t k, std::size_t s, const PointValues& y) const {
    const Root& root = root_[b];
    if (k >= dim) return scale_[b][s] * root.alpha * std::sqrt(0.5) * y[b][k][s];
    double sum = 0.0;
    for (std::size_t i = 0; i < dim; ++i) sum += y[b][i][s];
    return scale_[b][s] * (root.alpha * y[b][k][s] + root.beta * sum);
  }

  NodeValues product(const PointValues& y) {
    s_.gravity = {};
    s_.scene.water_table.reset();
    put_stress([&](std::size_t b, std::size_t k, std::size_t s) { return rooted(b, k, s, y); });
    return weighted_velocities();
  }

  PointValues transposed_product(const NodeValues& z) {
    GridOf<dim>& grid = s_.grid;
    for (std::size_t k = 0; k < z.size(); ++k) {
      NodeBlockOf<dim>& nb = grid.node_blocks[k];
      for (std::size_t n = 0; n < nb.mass.size(); ++n)
        for (std::size_t i = 0; i < dim; ++i) nb.v[i][n] = std::sqrt(nb.mass[n]) * z[k][i][n];
    }
    transpose_walls(grid, mirrored_);
    contact_.transpose(grid);
    if constexpr (dim == 2)
      if (walls_.periodic()) transpose_periodic_edges(grid);
    for (NodeBlockOf<dim>& nb : grid.node_blocks)
      for (std::size_t n = 0; n < nb.mass.size(); ++n)
        for (std::size_t i = 0; i < dim; ++i)
          nb.v[i][n] = nb.mass[n] > 0.0 ? nb.v[i][n] / nb.mass[n] : 0.0;
    for_each_block(s_.arena, grid.point_blocks.size(), [&](std::size_t k) {
      choose<dim>(s_.scene, true, false,
                  [&]<class Kernel>(Kernel, auto, auto) { strain_block<Kernel>(k); });
    });
    PointValues y = zeros(), of_strain = zeros();
    for (std::size_t b = 0; b < y.size(); ++b) {
      PointsOf<dim>& points = s_.bodies[b];
      for (std::size_t s = 0; s < points.slots(); ++s) {
        if (!(scale_[b][s] > 0.0)) continue;
        const double V = points[At::mass][s] / points[At::rho][s];
        each_stress<dim>([&](std::size_t k, std::size_t i, std::size_t j) {
          const double of = i == j
                                ? points[At::L + dim * i + i][s]
                                : points[At::L + dim * i + j][s] + points[At::L + dim * j + i][s];
          of_strain[b][k][s] = -V * of;
        });
        for (std::size_t k = 0; k < stresses; ++k) y[b][k][s] = rooted(b, k, s, of_strain);
      }
      for (std::size_t k = 0; k < At::gradient; ++k)  // it may be the field that goes to the grid
        std::fill_n(points.data(At::L + k), points.slots(), 0.0);
    }
    return y;
  }

  /// The gradient of the nodes' velocity at the points of a block.
  template <class Kernel>
  void strain_block(std::size_t block) {
    GridOf<dim>& grid = s_.grid;
    const PointBlockOf<dim>& pb = grid.point_blocks[block];
    VelocityTileOf<dim> tile;
    for (std::size_t i = 0; i < dim; ++i)
      fill_tile(pb, tile.v[i], [&](std::size_t k) { return grid.node_blocks[k].v[i].data(); });
    static thread_local AlignedVector<double> scratch;
    for (std::size_t b = 0; b < s_.bodies.size(); ++b) {
      const SlotRange& range = pb.range[b];
      if (range.count == 0) continue;
      const std::size_t n = padded(range.count);
      scratch.resize(std::max(scratch.size(), dim * n));
      MotionOf<dim> motion;
      for (std::size_t i = 0; i < dim; ++i) motion.v[i] = scratch.data() + i * n;
      PointsOf<dim>& points = s_.bodies[b];
      tile_to_points<Kernel, Keeps::nothing, false>(tile, tile_origin(pb), grid.h(), range, {},
                                                    points, motion);
      for (std::size_t i = 0; i < dim; ++i)  // the points stay at rest
        std::fill_n(points.data(At::v + i) + range.begin, n, 0.0);
    }
  }

  PointValues zeros() const {
    PointValues y(s_.bodies.size());
    for (std::size_t b = 0; b < y.size(); ++b)
      for (std::vector<double>& values : y[b]) values.assign(s_.bodies[b].slots(), 0.0);
    return y;
  }
  static double norm(const NodeValues& z) {
    double sum = 0.0;
    for (const auto& block : z)
      for (const auto& values : block)
        for (const double x : values) sum += x * x;
    return std::sqrt(sum);
  }
  static double norm(const PointValues& y) {
    double sum = 0.0;
    for (const auto& body : y)
      for (const auto& values : body)
        for (const double x : values) sum += x * x;
    return std::sqrt(sum);
  }
  /// x ← a x + b y
  static void combine(double a, NodeValues& x, double b, const NodeValues& y) {
    for (std::size_t k = 0; k < x.size(); ++k)
      for (std::size_t i = 0; i < dim; ++i)
        for (std::size_t n = 0; n < x[k][i].size(); ++n)
          x[k][i][n] = a * x[k][i][n] + b * y[k][i][n];
  }
  static void combine(double a, PointValues& x, double b, const PointValues& y) {
    for (std::size_t k = 0; k < x.size(); ++k)
      for (std::size_t i = 0; i < stresses; ++i)
        for (std::size_t n = 0; n < x[k][i].size(); ++n)
          x[k][i][n] = a * x[k][i][n] + b * y[k][i][n];
  }

  /// Adds the least Δσ that takes the accelerations b away: LSQR in the notation of Paige &
  /// Saunders, with u, v and w as there and y for x.
  void correct(const NodeValues& b, int& products) {
    NodeValues u = b;
    double beta = norm(u);
    const double target = std::max(
        0.3 * beta, 0.03 * Equilibrium::exact * beta / std::max(share_of_weight(b), 1e-300));
    if (beta == 0.0) return;
    combine(-1.0 / beta, u, 0.0, u);
    PointValues v = transposed_product(u), y = zeros();
    double alpha = norm(v);
    if (alpha == 0.0) return;
    combine(1.0 / alpha, v, 0.0, v);
    PointValues w = v;
    double phi = beta, rho = alpha;
    const double first = alpha * beta;
    double best = HUGE_VAL;
    for (int since_best = 0; phi > target && since_best < products_of_patience; ++since_best) {
      ++products;
      if (phi < 0.9 * best) {
        best = phi;
        since_best = 0;
      }
      NodeValues Av = product(v);
      combine(-alpha, u, 1.0, Av);
      beta = norm(u);
      if (beta > 0.0) combine(1.0 / beta, u, 0.0, u);
      const PointValues Au = transposed_product(u);
      combine(-beta, v, 1.0, Au);
      alpha = norm(v);
      if (alpha > 0.0) combine(1.0 / alpha, v, 0.0, v);
      const double r = std::hypot(rho, beta), c = rho / r, s = beta / r;
      combine(1.0, y, c * phi / r, w);
      combine(-s * alpha / r, w, 1.0, v);
      rho = -c * alpha;
      phi *= s;
      // nothing more to be had: the transposed of the residual, against where it began
      if (std::abs(phi * alpha * c) < 1e-12 * first) break;
    }
    for (std::size_t body = 0; body < y.size(); ++body)
      for (std::size_t slot = 0; slot < s_.bodies[body].slots(); ++slot) {
        Sym<double, 6>& stress = stress_[body][slot];
        for (std::size_t k = 0; k < stresses; ++k) stress[component(k)] += rooted(body, k, slot, y);
        if constexpr (dim == 2)  // plane strain
          stress[2] += root_[body].nu * (rooted(body, 0, slot, y) + rooted(body, 1, slot, y));
      }
  }

  /// Brings all points to what their law admits, and gives them its density and state. Returns how
  /// many were at a limit.
  std::int64_t admit() {
    std::int64_t limited = 0;
    for (std::size_t b = 0; b < s_.bodies.size(); ++b) {
      PointsOf<dim>& points = s_.bodies[b];
      const Strength strength(*points.material);
      for (std::size_t s = 0; s < points.slots(); ++s) {
        if (!(scale_[b][s] > 0.0)) continue;
        const double volume = points[At::mass][s] / points[At::rho][s];
        Sym<double, 6>& stress = stress_[b][s];
        if (fluid_[b]) stress[2] = stress[0];
        bool at_limit = false;
        if (strength.M > 0.0 || fluid_[b]) {
          const double p = pressure(stress);
          if (p < least_pressure_[b][s]) {
            stress = stress + Sym<double, 6>::isotropic(p - 3.0 * least_pressure_[b][s]);
            at_limit = true;
          }
          const double used = strength.used(stress);
          if (used > most_used_[b][s]) {
            const double p_now = pressure(stress);
            stress = (0.9 * most_used_[b][s] / used) * deviator(stress) -
                     Sym<double, 6>::isotropic(p_now);
            at_limit = true;
          }
        }
        limited += at_limit ? 1 : 0;
        const InitialPoint point = state_under(b, stress);
        points.set(At::rho, s, point.density);
        points.set(At::mass, s, point.density * volume);
        for (std::size_t k = 0; k < point.state.size(); ++k)
          points.set(At::state + k, s, point.state[k]);
        stress = point.stress;
      }
    }
    return limited;
  }

  InitialPoint state_under(std::size_t b, const Sym<double, 6>& stress) const {
    const Material& material = *s_.bodies[b].material;
    InitialConditions here;
    here.ocr = s_.scene.bodies[b].initial.ocr;
    if (fluid_[b]) {
      here.p = pressure(stress);
      return material.initial(here);
    }
    here.sigma.emplace();
    for (std::size_t k = 0; k < 6; ++k) (*here.sigma)[k] = -stress.c[k];
    if (here.ocr) {
      try {
        return material.initial(here);
      } catch (const InputError&) {  // its surface goes through the stress then
        here.ocr.reset();
      }
    }
    return material.initial(here);
  }

  /// The residual with edges and surfaces as they are.
  double as_the_step_does() {
    accelerations();
    s_.update_grid(1.0);  // without edges and surfaces again
    if constexpr (dim == 2)
      if (walls_.periodic()) join_periodic_edges(s_.grid);
    double work = 0.0;
    Walls walls = s_.walls;
    for (Wall* wall : {&walls.left, &walls.right, &walls.floor, &walls.top}) wall->speed = 0.0;
    std::vector<Surface> surfaces = rigid_surfaces(s_.scene);
    for (Surface& surface : surfaces) {
      surface.velocity = {};
      surface.spin = 0.0;
    }
    RigidContact<dim>(surfaces).apply(s_.grid, 0.0, true, s_.arena, work);
    apply_walls(s_.grid, walls);
    return share_of_weight(weighted());
  }

  /// The points as they were given, with the stress and state that were found.
  void give_back() {
    s_.gravity = gravity_;
    s_.scene.water_table = scene_.water_table;
    s_.tiles_are_current = false;
    for (std::size_t b = 0; b < s_.bodies.size(); ++b) {
      PointsOf<dim>& points = given_[b];
      const PointsOf<dim>& found = s_.bodies[b];
      for (std::size_t s = 0; s < points.slots(); ++s) {
        if (!(scale_[b][s] > 0.0)) continue;
        const Sym<double, 6>& stress = stress_[b][s];
        for (std::size_t k = 0; k < At::components; ++k) points.set(At::stress + k, s, stress.c[k]);
        points.set(At::rho, s, found[At::rho][s]);
        points.set(At::mass, s, found[At::mass][s]);
        for (std::size_t k = 0; k < points.state_fields(); ++k)
          points.set(At::state + k, s, found[At::state + k][s]);
        if (points.splits_stress()) {
          points.set(points.force_stress[0], s, mean(stress));
          points.set(points.force_stress[2], s, 0.0);
        } else {
          for (std::size_t k = 0; k < stresses; ++k)
            points.set(points.force_stress[k], s, stress[component(k)]);
        }
      }
      copy_into_padding(points, b);
    }
    s_.bodies.swap(given_);
  }

  /// Padding repeats the last point of its range.
  void copy_into_padding(PointsOf<dim>& points, std::size_t b) const {
    for (const PointBlockOf<dim>& pb : s_.grid.point_blocks) {
      const SlotRange& range = pb.range[b];
      for (std::size_t s = range.begin + range.count; s < range.begin + padded(range.count); ++s)
        for (std::size_t f = 0; f < points.fields; ++f)
          points.set(f, s, points[f][range.begin + range.count - 1]);
    }
  }

  using Stress = std::vector<Sym<double, 6>>;
  Impl& s_;
  std::vector<PointsOf<dim>> given_;
  std::array<double, dim> gravity_;
  Scene scene_;
  Walls walls_;
  RigidContact<dim> contact_;
  bool connected_ = false;
  std::vector<MirroredTriple> mirrored_;
  std::vector<Stress> stress_;              ///< by body and slot
  std::vector<std::vector<double>> scale_;  ///< c/√V; 0: not to be changed
  std::vector<std::vector<double>> least_pressure_, most_used_;
  std::vector<bool> fluid_;
  std::vector<Root> root_;
};

}  // namespace

template <int dim>
void Simulation::Impl<dim>::seek_equilibrium() {
  if (!seeks_equilibrium(scene) || !scene.start_from.empty() || prescribed.acceleration ||
      prescribed.start)
    return;
  equilibrium = EquilibriumSearch<dim, Impl>(*this).run();
}

template void Simulation::Impl<2>::seek_equilibrium();
template void Simulation::Impl<3>::seek_equilibrium();

}  // namespace repose::mpm
