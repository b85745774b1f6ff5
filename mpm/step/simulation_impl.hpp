#pragma once
/// \file
/// The state of a simulation and the stages of its step, in the plane or in space. Private to mpm/.

#include <numbers>

#include <tbb/task_arena.h>

#include "mpm/boundary/periodic.hpp"
#include "mpm/boundary/rigid_contact.hpp"
#include "mpm/boundary/wall_parts.hpp"
#include "mpm/grid/grid.hpp"
#include "mpm/step/equilibrium.hpp"
#include "mpm/step/flow_maps.hpp"
#include "mpm/step/implicit_viscosity.hpp"
#include "mpm/step/ledger.hpp"
#include "mpm/step/simulation.hpp"
#include "mpm/step/step_size.hpp"
#include "mpm/step/transfer.hpp"

namespace repose::mpm {

/// g (sin, −cos) of a scene, with nothing along z [m/s²].
template <int dim>
std::array<double, dim> gravity_of(const Scene& scene) {
  const double angle = scene.tilt_deg * std::numbers::pi / 180.0;
  return {scene.gravity * std::sin(angle), -scene.gravity * std::cos(angle)};
}

/// What the tiles' last channel carries.
enum class Extra : std::uint8_t { nothing, elastic, signal };

template <int dim>
class Simulation::Impl {
 public:
  Impl(const Scene& scene, const Prescribed& prescribed, int threads);

  void step(double stop_at);

  // --- the algorithm box, one function per stage ---
  void let_in();  ///< rows of points that have come in through an edge
  void sort_if_needed();
  double choose_step(double stop_at) const;
  void points_to_grid();             ///< P2G: mass, momentum, internal force of every block's tile
  void update_grid(double dt);       ///< sum tiles, accelerate nodes
  void apply_boundaries(double dt);  ///< surfaces, then the edges of the box
  void measure_signals();            ///< now and then: what the grid sees of them (step_size.hpp)
  void solve_viscosity(double dt);   ///< implicit viscous forces, if any; throws NumericalFailure
  void extend_velocity();            ///< XPIC, FMPM beyond first order (extended_pic.cpp)
  void grid_to_points(double dt);    ///< G2P, move, update stress, P2G of the next step
  void close_ledger();               ///< kinetic energies before and after; throws NumericalFailure

  void observe_flow(double way);  ///< for the maps of a terrain
  /// Corrects the stresses of a start at rest (equilibrium.hpp), if the scene asks for it.
  void seek_equilibrium();

  SeriesRow diagnostics();
  Deposit deposit() const;
  std::int64_t live_cells() const;
  Snapshot snapshot() const;
  Sight look_at(const std::array<double, 3>& place) const;
  Sight tracer(std::size_t k) const;
  PointFields point_fields() const;
  NodeFields node_fields();
  void set_gravity(double gravity, double tilt_deg);
  void set_wall(std::string_view edge, const Wall& wall);
  std::vector<std::string> warnings() const;
  Counters counters() const;
  void save(const std::filesystem::path& file) const;
  void load(const std::filesystem::path& file);
  void save_final_state(const std::filesystem::path& file) const;
  /// Takes the points of all bodies from a result. Throws InputError.
  void start_from(const std::filesystem::path& folder);
  void require_room(const PointsOf<dim>& points, std::size_t body) const;
  /// Gravity at this time: while it grows, 3x² − 2x³ of it at the share x of the ramp.
  std::array<double, dim> gravity_now() const;
  void follow_ramp();  ///< gravity of the time that a step has led to
  /// Changes gravity; the potential energy that this gives to the points counts as there from the
  /// start.
  void change_gravity(const std::array<double, dim>& to);
  double potential() const;
  /// Of a point: its weight is m (g − what is buoyant of it)
  double buoyant(std::size_t body, double y) const {
    return scene.water_table && y < *scene.water_table ? buoyant_[body] : 0.0;
  }
  /// Potential energy of a point over its mass: −g·x, below the water table + s g·(0, y − y_w).
  template <class At>
  double height_energy(std::size_t body, At&& x) const {
    double energy = 0.0;
    for (std::size_t i = 0; i < dim; ++i) energy -= gravity[i] * x(i);
    if (const double share = buoyant(body, x(1)); share != 0.0)
      energy += share * gravity[1] * (x(1) - *scene.water_table);
    return energy;
  }
  /// Kinetic, elastic, potential sums over the points as they are, in a fixed order.
  struct Energies {
    double kinetic = 0.0, potential = 0.0, elastic = 0.0;
  };
  Energies energies();
  Signals initial_signals() const;
  Signals signals_of(const PointsOf<dim>& points) const;
  /// The edges as they are now: in parts where material comes in.
  Walls walls_now() const;
  /// All that could ever become motion: every point in the lowest corner of the box, unstressed,
  /// and the round-off of its wave energy where there is nothing else. HUGE_VAL where something
  /// works on the points without bound.
  double energy_bound() const;
  /// The signals as the grid sees them.
  Signals seen() const {
    return {signals.speed, node_share * signals.signal, signals.viscous_rate};
  }

  Scene scene;
  std::array<double, dim> gravity{};
  Walls walls;
  RigidContact<dim> contact;
  std::vector<PointsOf<dim>> bodies;
  std::vector<std::string> body_names;
  GridOf<dim> grid;
  mutable tbb::task_arena arena;
  int threads;

  /// Of every inflow: what its points are, how fast they come, rows made so far
  struct Entry {
    InitialPoint state;
    double speed;
    std::int64_t rows = 0;
  };
  std::vector<Entry> entries;
  std::int64_t next_id = 0;          ///< of the next point to be made
  std::vector<std::int64_t> traced;  ///< points that tracers follow

  Prescribed prescribed;
  std::vector<double> start_x, start_y;  ///< by point id, if an acceleration is prescribed [m]

  double time = 0.0;
  std::int64_t steps = 0;
  std::int64_t point_steps = 0;
  double last_dt = 0.0;
  double dt_min = HUGE_VAL, dt_max = 0.0;
  double drift = 0.0;  ///< bound on the way any point has gone since the last sort [m]
  bool must_sort = true;
  bool tiles_are_current = false;  ///< the tiles hold the points as they are
  double tiles_time = 0.0;         ///< the moment whose forces they hold [s]
  std::int64_t sorts = 0;
  std::int64_t wall_corrections = 0;
  std::int64_t newton_iterations = 0, cg_iterations = 0;  ///< of the implicit viscosity
  std::int64_t points_held = 0;                           ///< at the density floor in the last step
  std::int64_t most_points_held = 0;                      ///< in any step
  std::int64_t point_steps_held = 0;                      ///< summed over steps
  double fixed_step_excess = 0.0;    ///< largest dt/(wave limit) of a fixed step
  double viscous_step_excess = 0.0;  ///< largest dt/(viscous limit) of a fixed step
  double first_dt = 0.0;
  Signals signals;          ///< of the points
  double node_share = 1.0;  ///< largest signal of a node over that of a point (step_size.hpp)
  Ledger ledger;
  Equilibrium equilibrium;
  double highest_energy = 0.0;   ///< what kinetic energy can never exceed [J/m]
  std::optional<FlowMaps> maps;  ///< of a scene with a terrain
  double initial_height = 0.0;   ///< H_0: top of the highest body, depth of a release [m]

 private:
  struct BlockSums {
    double kinetic = 0.0;
    double work = 0.0;
    double plastic = 0.0, viscous = 0.0, hypoelastic = 0.0, separation = 0.0;  ///< StepWork
    double averaging = 0.0;    ///< taken by the averaging of pressures
    double held_energy = 0.0;  ///< taken by the density floor, stored energy
    std::int64_t held = 0;     ///< points at the density floor
    double power = 0.0;
    Signals signals;
    double pushed = 0.0;  ///< farthest that a rigid surface has put a point [m]
    std::int64_t corrections = 0;
    bool outflow = false;
    bool transferred = false;  ///< its tile holds the points as they are
    std::string failure;
  };
  template <class Kernel, bool affine, Extra extra>
  void transfer_to_tile(std::size_t block);
  void transfer_to_tile(std::size_t block, Extra extra);
  static void square_signals(PointsOf<dim>& points, const SlotRange& range, double* signal2);
  template <class Kernel>
  void prescribed_force_to_tile(const PointSet& points, const SlotRange& range,
                                std::array<int, 2> origin, Tile& tile) const;
  template <class Kernel, Keeps keeps, bool averages>
  void advance_block(std::size_t block, double dt, const Retention& keep, BlockSums& sums);
  /// `near_surface`: a rigid surface may be among the points.
  void move(PointsOf<dim>& points, const SlotRange& range, const MotionOf<dim>& motion, double dt,
            bool near_surface, BlockSums& sums) const;
  /// Arrays of a range's length: velocity and mean elastic strain (Motion), and in strain() a
  /// strain, a spin, work and what it is spent on (3), modulus, viscosity and pressure, and where
  /// contacts damp a stress and work.
  static constexpr std::size_t scratch_arrays =
      dim + 1 + 2 * Layout<dim>::components + (dim == 2 ? 1 : 3) + 8;
  /// Brings a range's stress to the end of the step.
  void strain(PointsOf<dim>& points, std::size_t body, const SlotRange& range,
              const MotionOf<dim>& motion, double dt, double* scratch, BlockSums& sums) const;
  /// Keeps a range's densities at or above the density floor. `averaging`: energies of the
  /// averaging (take_back_averaging_work), if it averages; `stored`: room.
  void hold_density(PointsOf<dim>& points, const SlotRange& range,
                    const typename PointsOf<dim>::Batch& batch, double* averaging, double* stored,
                    BlockSums& sums) const;
  /// The loosest density of a point over its mass: what it has alone in its stencil, m Σw²/h²
  /// (Σw² = 0.21 to 0.25, cubic; more, quadratic; in space 0.097 to 0.125 over h³). Looser than
  /// that the grid cannot tell, and spray would dilate without end. [1/m², in space 1/m³]
  double density_floor() const {
    const double h = grid.h();
    return dim == 2 ? 0.2 / (h * h) : 0.09 / (h * h * h);
  }
  /// Adds a range's energies, work, power and signals after its update.
  void sum_up(const PointsOf<dim>& points, std::size_t body, const SlotRange& range,
              const typename PointsOf<dim>::Batch& batch, const MotionOf<dim>& motion,
              BlockSums& sums) const;
  /// The fields of the stress that gives the explicit forces, as in Sym.
  static std::array<std::size_t, Layout<dim>::components> force_components(
      const PointsOf<dim>& points) {
    const auto& s = points.force_stress;
    if constexpr (dim == 2)  // of an isotropic split stress, zz is what xx is
      return {s[0], s[1], points.splits_stress() ? s[0] : std::size_t{SZZ}, s[2]};
    else
      return s;
  }
  /// How far a point may be from the cell it was sorted into [m].
  double reach() const { return 0.98 * grid.h(); }
  bool averages() const { return dim == 2 && scene.pressure_averaging > 0.0; }
  /// Whether this step, or the n-th after it, measures node_share.
  bool measures(int n = 0) const { return !averages() && (steps + n) % 16 == 0; }
  Extra extra(int n) const {
    return averages() ? Extra::elastic : measures(n) ? Extra::signal : Extra::nothing;
  }
  /// What the scene's transfer keeps over a step.
  Retention retention(double dt) const;
  void remove_outflow();
  bool flows(std::size_t inflow) const {
    return time >= scene.inflows[inflow].starts && time < scene.inflows[inflow].stops;
  }
  double initial_power() const;
  /// −Vσ:L + mg·v of one point after a step of length dt, as in sum_up() [W/m].
  double power_of(const PointsOf<dim>& points, std::size_t body, std::size_t slot, double dt) const;
  std::string describe(const PointsOf<dim>& points, std::size_t body, std::size_t slot) const;

  /// What water bears of the points of a body below the water table, m s (−g) each.
  template <class Kernel>
  void buoyancy_to_tile(const PointsOf<dim>& points, std::size_t body, const SlotRange& range,
                        const std::array<int, Shape<dim>::axes>& origin, TileOf<dim>& tile) const;

  std::vector<double> buoyant_;  ///< s = ρ_w/ρ_s of each body (fill.hpp)
  std::vector<BlockSums> block_sums_;
  std::vector<NodeSums> node_sums_;  ///< per block of nodes; the last of a periodic edge
  WallEffect wall_effect_;
  std::int64_t contact_sorts_ = -1;       ///< the sort whose blocks the contact knows
  std::vector<MirroredTriple> mirrored_;  ///< what the walls did, for the extension
  /// Of the extension: its remainder r, A r, and what it has added up.
  NodeVector remainder_, through_points_, extension_;
  ImplicitViscosity viscosity_;
  ViscousEffect viscous_effect_;
};

// of the plane alone
template <>
void Simulation::Impl<2>::solve_viscosity(double dt);
template <>
void Simulation::Impl<2>::extend_velocity();

template <class F>
auto Simulation::visit(F&& f) const {
  return plane_ ? f(*plane_) : f(*space_);
}

}  // namespace repose::mpm
