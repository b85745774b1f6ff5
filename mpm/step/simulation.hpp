#pragma once
/// \file
/// The Material Point Method simulation of one scene, in plane strain or in three dimensions.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>

#include "io/frame_writer.hpp"
#include "mpm/grid/numerical_failure.hpp"
#include "mpm/scene/prescribed.hpp"
#include "mpm/scene/scene.hpp"

namespace repose::mpm {

class FlowMaps;       // step/flow_maps.hpp
struct Deposit;       // output/deposit.hpp
struct RestPressure;  // output/rest_pressure.hpp

/// Whose stress is looked at.
enum class Stress {
  averaged,  ///< of a point's neighbourhood, as the grid sees it: output/averaged_stress.hpp
  points,    ///< the point's own, which the law goes on from: with noise that no force shows
};
/// Their names in scene files, in the same order.
constexpr std::array<std::string_view, 2> stress_names{"averaged", "points"};

/// One row of series.csv, in plane strain per metre of depth; in space everything that is named
/// _per_m is a total in J or kg.
struct SeriesRow {
  double time_s, dt_s;
  std::int64_t step;
  /// Largest x (of a cylinder: radius about its axis) with solid depth (column mass/ρ_0) >= 0.02
  /// H_0
  double front_m;
  double front_max_m;  ///< largest x (radius) of any point
  double front_99_m;   ///< x (radius) up to which lies 99 % of the mass in the box
  double height_m;     ///< solid depth at the left wall, of a cylinder on its axis
  double kinetic_J_per_m, potential_J_per_m, elastic_J_per_m;
  double dissipated_J_per_m;       ///< by the material: plastic + viscous
  double plastic_J_per_m;          ///< friction and plastic compaction
  double viscous_J_per_m;          ///< viscous stress
  double hypoelastic_J_per_m;      ///< taken by an elasticity without a potential
  double separation_J_per_m;       ///< lost or made where contact is (StepWork, models/law.hpp)
  double averaging_loss_J_per_m;   ///< stored energy taken by pressure averaging (numerical)
  double density_floor_J_per_m;    ///< stored energy taken by the density floor (numerical)
  double transfer_loss_J_per_m;    ///< kinetic energy lost between points and grid (numerical)
  double wall_loss_J_per_m;        ///< taken by the walls: impact and friction
  double energy_residual_J_per_m;  ///< what the ledger does not account for (time integration)
  double work_residual_J_per_m;    ///< of that: stress work that no line accounts for
  double mass_kg_per_m;
  double outflow_kg_per_m;                    ///< mass that has left through open edges
  double inflow_kg_per_m;                     ///< mass that has come in
  double momentum_x, momentum_y, momentum_z;  ///< [kg m/s per m]
  /// About the origin, of which the plane has z, the affine velocity included [kg m²/s per m]
  double angular_momentum, angular_momentum_x, angular_momentum_y;
  double density_min, density_max;  ///< [kg/m³]
  std::int64_t points_separated;    ///< points that carry no stress
};

class Simulation {
 public:
  /// Fills the bodies with points. `threads` <= 0: all cores. Throws InputError (see validate()).
  explicit Simulation(const Scene& scene, int threads = 0);
  /// The same with initial velocities and body accelerations of the program's own; in the plane.
  Simulation(const Scene& scene, const Prescribed& prescribed, int threads = 0);
  ~Simulation();
  Simulation(Simulation&&) noexcept;

  /// Advances one step, shortened to land exactly on `stop_at` [s]; none if that is not ahead.
  /// Throws NumericalFailure.
  void step(double stop_at);

  const Scene& scene() const;
  double time() const;  ///< [s]
  std::int64_t steps() const;
  std::int64_t point_count() const;
  std::int64_t live_cells() const;   ///< cells that hold a point
  double next_dt() const;            ///< the step that the next call would take, stops aside [s]
  std::int64_t point_steps() const;  ///< points advanced so far, summed over steps

  SeriesRow diagnostics() const;

  /// Solid depth over x, or the radius (SeriesRow::front_m): column mass/ρ_0 per cell column.
  struct Profile {
    std::vector<double> x_m, depth_m;
  };
  Profile profile() const;

  /// What the flow over a terrain has left at the nodes (i h, k h) of its plan, x first.
  struct PlanMaps {
    std::size_t columns, rows;
    double h;                         ///< [m]
    double least_depth;               ///< from which on a node counts as reached [m]
    std::vector<double> depth_max_m;  ///< largest solid depth, measured along y
    std::vector<double> speed_max;    ///< largest mean speed of a column so deep [m/s]
    std::vector<double> arrival_s;    ///< when it first was so deep; HUGE_VAL: never
    std::vector<double> depth_m;      ///< solid depth now
  };
  /// Errors: InputError for a scene without a terrain.
  PlanMaps plan_maps() const;

  /// A flow over a terrain as it is now. Distances are those in the plan from the nearest cell that
  /// held a point at the start, straight [m].
  struct FlowExtent {
    double runout_99_m = 0.0;   ///< up to which lies 99 % of the mass in the box
    double runout_max_m = 0.0;  ///< of the farthest point
    double area_m2 = 0.0;       ///< of the plan where the solid depth is at least least_depth
    double reached_m2 = 0.0;    ///< where it ever was
    double depth_mean_m = 0.0, depth_max_m = 0.0;  ///< solid depth over that area
    double speed_mean = 0.0;                       ///< of all mass [m/s]
    double speed_max = 0.0;                        ///< largest mean speed of a column so deep [m/s]
  };
  /// Errors: as plan_maps().
  FlowExtent flow_extent() const;

  /// Pressure against overburden, for a deposit in the plane at rest (gravity along −y): points
  /// deeper than 2h below the surface, where the deposit has at least a quarter of its greatest
  /// depth.
  RestPressure rest_pressure(Stress of = Stress::averaged) const;

  /// All points in a fixed order (their order of creation), for frames and pictures.
  struct Snapshot {
    std::vector<double> x_m, y_m, vx, vy, density, pressure_Pa, mises_Pa, sxx, syy, szz, sxy;
    std::vector<double> shear_rate;         ///< γ̇ = √(2D′:D′) [1/s]
    std::vector<double> mass;               ///< [kg/m], in space [kg]
    std::vector<double> z_m, vz, syz, szx;  ///< in space, else empty
    std::vector<std::int32_t> body;
    std::vector<std::int64_t> id;      ///< number of the point, from 0 in the order of creation
    std::vector<double> shear_strain;  ///< ∫γ̇ dt [-] of a scene that keeps it, else empty
    /// A state variable of a law; NaN at the points of laws without one of this name.
    struct StateVariable {
      const StateField* field;
      std::vector<double> values;
    };
    std::vector<StateVariable> state;
    io::FrameView view(double time_s) const;  ///< refers to this snapshot
    /// In space, the points between two heights z [m].
    Snapshot slice(double from, double to) const;
  };
  Snapshot snapshot(Stress of = Stress::points) const;

  /// Everything that the points carry, in the order of their creation: row by row, `dimensions`
  /// numbers of a vector, the components of Sym (models/sym.hpp) of a stress.
  struct PointFields {
    std::size_t dimensions = 2, components = 4;
    std::size_t state_width = 0;  ///< most state variables of a body's law
    std::vector<std::int64_t> id;
    std::vector<std::int32_t> body;
    std::vector<double> position, velocity;  ///< [m], [m/s]
    std::vector<double> velocity_gradient;   ///< L_ij = dv_i/dx_j, row by row [1/s]
    std::vector<double> stress;              ///< the point's own, tension positive [Pa]
    std::vector<double> density, mass;       ///< [kg/m³], [kg/m] (in space [kg])
    /// Variables of the law of the point's body, in table order; NaN beyond those that it has
    std::vector<double> state;
  };
  PointFields point_fields() const;

  /// The nodes of the box in the last step, x slowest: mass, that of a node behind an edge added to
  /// the node that it mirrors (behind a periodic edge, to the node it is; the last node along x is
  /// then the first and left empty), and velocity after forces and walls. Zero where no point is
  /// near, and before the first step.
  struct NodeFields {
    std::vector<std::size_t> nodes;  ///< along each axis
    std::vector<double> mass;        ///< [kg/m], in space [kg]
    std::vector<double> velocity;    ///< [m/s]
  };
  NodeFields node_fields() const;

  /// What is at a place.
  struct Sight {
    double depth = 0.0;  ///< solid depth of the column there: its mass over ρ_0 [m]
    /// Mass of the points within a cell, weighted (probes.cpp) [kg/m], in space [kg]; 0: nothing is
    /// there, nor in what follows
    double mass = 0.0;
    std::array<double, 3> position{};  ///< of a tracer; of a probe, the place [m]
    std::array<double, 3> velocity{};  ///< [m/s]
    double pressure = 0.0, q = 0.0;    ///< p and √(3/2 s:s) [Pa]
    double density = 0.0;              ///< [kg/m³]
  };
  Sight look_at(const std::array<double, 3>& place) const;
  /// The material point that a tracer of the scene follows; without mass once it has left the box.
  Sight tracer(std::size_t k) const;

  /// Goes on under another gravity, as Scene::gravity and tilt_deg [m/s²], [°]. The potential
  /// energy that this gives to the points counts as there from the start, so that the ledger still
  /// closes; a relaxation time that followed from gravity stays what it was, and a ramp has ended.
  /// Throws InputError.
  void set_gravity(double gravity, double tilt_deg);
  /// Goes on with another edge: "floor", "left", "right", "top", in space "near" and "far". Edges
  /// do not become periodic or cease to be. Throws InputError, with the edges there are.
  void set_wall(std::string_view edge, const Wall& wall);

  /// Things a user should know: a fixed step beyond a stability limit, wall corrections, ...
  std::vector<std::string> warnings() const;
  /// Figures for summary.json beyond the last row of the series.
  struct Counters {
    double dt_min_s, dt_max_s;
    double surface_work;  ///< of moving rigid surfaces on the material [J/m], in space [J]
    std::int64_t wall_corrections;  ///< points put back on a wall after crossing it by round-off
    std::int64_t sorts;
    /// Points whose density the floor held up: in the last step, the most in any step, summed over
    /// all steps
    std::int64_t points_held, most_points_held, point_steps_held;
    std::int64_t newton_iterations, cg_iterations;  ///< of the implicit viscosity
    /// What of the weight is out of balance at the start (step/equilibrium.hpp); 0: not sought
    double out_of_balance;
    double memory_MB;  ///< of points and grid
    int threads;
  };
  Counters counters() const;

  /// Whole state to one HDF5 file and back; a resumed run gives the same bits as one never stopped.
  void save(const std::filesystem::path& file) const;
  void load(const std::filesystem::path& file);
  /// What Scene::start_from takes the points from, as final_state.h5 in a folder.
  void save_final_state(const std::filesystem::path& file) const;

 private:
  friend class MidCollapse;  ///< bench/: starts from points that another resolution has moved
  template <int dim>
  class Impl;
  const FlowMaps& flow_maps() const;
  /// f(whichever of the two there is).
  template <class F>
  auto visit(F&& f) const;
  std::unique_ptr<Impl<2>> plane_;
  std::unique_ptr<Impl<3>> space_;
};

}  // namespace repose::mpm
