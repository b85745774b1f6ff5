#pragma once
/// \file
/// A scene in memory: what a scene file says, SI units, nothing computed yet.

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/registry.hpp"
#include "mpm/scene/solid.hpp"
#include "mpm/scene/terrain.hpp"

namespace repose::mpm {

/// What happens at an edge of the box.
struct Wall {
  enum class Kind {
    no_slip,   ///< velocity zero at the wall
    slip,      ///< a plane of symmetry: no motion through it nor away from it, free motion along it
    friction,  ///< unilateral Coulomb contact: no tension, |shear| <= friction × pressure
    open,      ///< material that crosses leaves the simulation and is counted as outflow
    periodic,  ///< left and right only, both: what crosses comes in on the other side
    parts,     ///< one of the others in each of its parts
    inflow,    ///< of a part where material comes in: never given, made of an Inflow
  };
  /// A stretch of an edge. Its ends along the edge: of floor and top x (in space and z), of left
  /// and right y (and z), of near and far x and y.
  struct Part {
    Kind kind = Kind::slip;
    double friction = 0.0;
    double speed = 0.0;  ///< for Kind::inflow, across the edge and inwards [m/s]
    std::array<double, 2> from{-HUGE_VAL, -HUGE_VAL}, to{HUGE_VAL, HUGE_VAL};  ///< [m]
  };
  Kind kind = Kind::slip;
  double friction = 0.0;      ///< Coulomb coefficient, for Kind::friction
  double speed = 0.0;         ///< of the wall along itself, +x or +y, for Kind::no_slip [m/s]
  std::vector<Part> parts{};  ///< for Kind::parts; the first that contains a place holds there
};

/// The edges by name: across x, y and z, the low one first.
constexpr std::array<std::string_view, 6> edge_names{"left", "right", "floor",
                                                     "top",  "near",  "far"};

/// Material that comes in through an edge.
struct Inflow {
  std::string name;
  std::size_t edge = 0;                                                      ///< of edge_names
  std::array<double, 2> from{-HUGE_VAL, -HUGE_VAL}, to{HUGE_VAL, HUGE_VAL};  ///< as Wall::Part
  std::size_t body = 0;                   ///< whose law and initial state it has
  std::optional<double> speed;            ///< along the inward normal [m/s]; or:
  std::optional<double> rate;             ///< mass per time [kg/s per m], in space [kg/s]
  double starts = 0.0, stops = HUGE_VAL;  ///< [s]
};

/// A place that is looked at over time; or where the material point is that is followed.
struct Probe {
  std::string name;
  std::array<double, 3> place{};  ///< [m]
};

/// A disc of points; with a hole, a ring. In space, the section of an upright cylinder.
struct Disc {
  std::array<double, 2> centre{};  ///< x and y, in space x and z [m]
  double radius = 0.0;             ///< [m]
  double hole = 0.0;               ///< radius of the hole [m]
};

/// A block of one material at rest or in uniform motion.
struct Body {
  std::string name;
  std::array<double, 3> origin{};  ///< lower left corner of the box [m]; z in space only
  std::array<double, 3> size{};    ///< [m]
  /// Only the points in it; origin and size bound it: set_disc(), set_cylinder()
  std::optional<Disc> disc;
  /// Only what of its lattice cells lies in it, in the plane; origin and size bound it:
  /// set_polygon()
  std::optional<Polygon> polygon;
  /// What the scene's terrain releases, in space; origin and size bound it: set_release()
  bool release = false;
  /// Only what of its lattice cells lies in it: a ball, a half-space, a tilted cylinder, a closed
  /// curve or a mesh; origin and size bound it: set_solid()
  std::optional<Solid> solid;
  /// Only what of its lattice cells lies in each of these, and in none of those
  std::vector<Solid> within, without;
  std::array<double, 3> velocity{};  ///< initial velocity [m/s]
  double spin = 0.0;  ///< initial angular velocity about z, through the body's centre [rad/s]
  LawSpec law;
  InitialConditions initial;
  /// The vertical stress is the weight of all that stands over a place (fill.hpp), the horizontal
  /// ones K0 times it; of `initial` only K0 (default 1) and ocr apply.
  bool lithostatic = false;
  /// Of the grains' contacts, which then damp elastic waves (step/contact_damping.hpp); 1: they do
  /// not
  std::optional<double> restitution;
};

enum class Kernel { quadratic, cubic };
/// Their names in scene files, in the same order.
constexpr std::array<std::string_view, 2> kernel_names{"quadratic", "cubic"};
constexpr std::string_view name_of(Kernel kernel) {
  return kernel_names[static_cast<std::size_t>(kernel)];
}

/// How velocities travel between points and grid; transfer.hpp has the formulas.
enum class Transfer {
  pic,      ///< points take the grid's velocity
  flip,     ///< points add its increment
  apic,     ///< as pic, with an affine velocity field around each point
  aflip,    ///< as flip, with the affine field of apic
  relaxed,  ///< points keep their own velocity and affine field, which relax towards the grid's at
            ///< a rate: the damping of apic per unit of time instead of per step
  tpic,     ///< as apic, with the spline's gradient for affine field, strain and force
  xpic,     ///< as flip, less what no grid velocity could be, filtered to the given order
  fmpm,     ///< as pic, with the full mass matrix inverted to the given order
};
/// Their names in scene files, in the same order.
constexpr std::array<std::string_view, 8> transfer_names{"pic",     "flip", "apic", "aflip",
                                                         "relaxed", "tpic", "xpic", "fmpm"};
constexpr std::string_view name_of(Transfer transfer) {
  return transfer_names[static_cast<std::size_t>(transfer)];
}

/// How the viscous stress of laws without stress memory acts.
enum class Viscosity {
  explicit_force,  ///< as a force of the stress from the last step; limits the step to 0.9 ρh²/4η
  implicit_solve,  ///< solved for at the end of the step (implicit_viscosity.hpp); no limit
};
/// Their names in scene files, in the same order.
constexpr std::array<std::string_view, 2> viscosity_names{"explicit", "implicit"};

/// How the points lie in memory between steps; the arithmetic is in double precision either way.
enum class Storage {
  double_precision,
  single_precision,  ///< 24 bits of every field, 48 of the position (points.hpp)
};
/// Their names in scene files, in the same order.
constexpr std::array<std::string_view, 2> storage_names{"double", "float"};

/// Where a step has a chance to be stable: the bulk is, in two directions, up to 1.93/√2 = 1.36
/// (cubic).
inline constexpr repose::Range courant_range{0.0, 1.4, true, false};

struct Scene {
  std::string name;
  double end_time = 0.0;      ///< [s]
  double gravity = 9.8;       ///< [m/s²], downwards
  double tilt_deg = 0.0;      ///< turns gravity so that material flows towards +x: g (sin, −cos)
  double gravity_ramp = 0.0;  ///< time over which gravity grows from 0 to what it is [s]
  /// Height below which bodies are buoyant [m]; absent: all is dry (step/buoyancy.hpp)
  std::optional<double> water_table;
  double water_density = 1000.0;  ///< [kg/m³]
  /// Whether the stresses of lithostatic bodies are corrected until they balance their weight
  /// (step/equilibrium.hpp); absent: seeks_equilibrium()
  std::optional<bool> equilibrium;
  /// The final state of another run (Simulation::save_final_state()): the points of the bodies come
  /// from there; empty: bodies are filled
  std::string start_from;

  /// Box from the origin to this corner [m]; without an extent along z the scene is plane strain,
  /// per metre of depth
  std::array<double, 3> domain{};
  std::size_t dimensions() const { return domain[2] == 0.0 && !terrain ? 2 : 3; }
  Wall floor{Wall::Kind::no_slip};
  Wall left{Wall::Kind::slip};
  Wall right{Wall::Kind::slip};
  Wall top{Wall::Kind::slip};
  Wall near{Wall::Kind::slip};             ///< at z = 0, in space
  Wall far{Wall::Kind::slip};              ///< at the other end of z
  const Wall& edge(std::size_t k) const {  ///< k of edge_names
    return *std::array{&left, &right, &floor, &top, &near, &far}[k];
  }

  std::vector<Body> bodies;
  std::vector<Surface> surfaces;   ///< rigid; bodies are cut by them
  std::optional<Terrain> terrain;  ///< ground that is one more of them, in space
  std::vector<Inflow> inflows;
  std::vector<Probe> probes;   ///< places
  std::vector<Probe> tracers;  ///< the material points nearest to these places at the start

  double h = 0.0;           ///< cell size [m]
  int points_per_cell = 4;  ///< a square number: 1, 4, 9, 16; in space a cube: 1, 8, 27
  Kernel kernel = Kernel::cubic;
  Transfer transfer = Transfer::relaxed;
  /// [s], for Transfer::relaxed; absent: default_relaxation_time()
  std::optional<double> relaxation_time;
  /// m of Transfer::xpic, k of Transfer::fmpm; 1 is pic. A step costs order − 1 more transfers.
  int order = 2;
  /// c: the pressure noise of the points decays as e^{−cγ} in shear γ [-]; 0: no averaging. Of the
  /// order of K/(ρ g H). See pressure_averaging.hpp.
  double pressure_averaging = 0.0;

  Viscosity viscosity = Viscosity::explicit_force;
  /// Largest error of an implicit step's velocity, over the velocity that its forces bring
  /// (root mean square by mass); implicit_viscosity.hpp says what it bounds.
  double viscosity_tolerance = 1e-3;

  Storage storage = Storage::double_precision;

  double courant = 0.8;      ///< Δt = courant · h/(c + |v|), if dt is absent; see step_size.hpp
  std::optional<double> dt;  ///< fixed step [s]

  bool shear_strain = false;     ///< points remember ∫γ̇ dt
  double frame_interval = 0.0;   ///< [s]; 0: no frames
  bool grid_frames = false;      ///< of the grid, beside every frame of the points
  double series_interval = 0.0;  ///< [s]; 0: first and last row only
};

/// How far lengths may be from whole cells and spacings, in these.
inline constexpr double lattice_tolerance = 1e-6;

/// Whether x is n times a unit for a whole n >= 1, to lattice_tolerance of the unit.
bool is_whole_multiple(double x, double unit);

/// Points along the edge of a cell: √points_per_cell, in space ∛points_per_cell.
int points_per_edge(const Scene& scene);

/// Distance between neighbouring points of a body at the start [m]: h/√points_per_cell, in space
/// h/∛points_per_cell.
double point_spacing(const Scene& scene);

/// 0.03 √(h/g), of the order of the largest stable step of soft grains [s]. Short
/// enough to quieten what the grid cannot carry, long enough that what it carries loses less than
/// in APIC at any stable step; docs/transfers.md has the measurements. HUGE_VAL without gravity.
double default_relaxation_time(const Scene& scene);

/// Whether an edge is in parts or lets material in.
bool has_edges_in_parts(const Scene& scene);

/// Whether the start is corrected to equilibrium: as `equilibrium` says or, where it says nothing,
/// where all bodies are lithostatic and there are several, or polygons among them.
bool seeks_equilibrium(const Scene& scene);

/// Makes a body a disc: its origin and size become those of the square around it.
void set_disc(Body& body, const Disc& disc);

/// Makes a body an upright cylinder from y = base to base + height. Where its axis lies in the wall
/// x = 0 or z = 0, that wall cuts it in half: its origin and size are those of the box around what
/// is left.
void set_cylinder(Body& body, const Disc& disc, double base, double height);

/// Makes a body a polygon: its origin and size become those of the box around it.
void set_polygon(Body& body, const Polygon& polygon);

/// Makes a body what a solid that is not hollow holds: its origin and size become those of the box
/// around it, and of a half-space around what of it lies in the box of the scene. In the plane a
/// half-space and a curve make it a polygon too.
void set_solid(Body& body, const Solid& solid, const std::array<double, 3>& domain);

/// Whether its points are those of a box on the lattice.
bool is_box(const Body& body);

/// Whether its lattice cells are cut, so that its mass is that of its volume, and lie on the grid's
/// own lattice.
bool is_cut(const Body& body);

/// A polygon that nothing else cuts.
bool is_plain_polygon(const Body& body);

/// Volume of a body, in the plane its area, before `within` and `without` and rigid surfaces cut it
/// [m³, m²]: for a disc and an upright cylinder that of the shape, not of its points.
double volume_of(const Scene& scene, const Body& body);

/// Makes a body what the terrain releases, on its ground: its origin and size become those of the
/// box around it.
void set_release(Body& body, const Terrain& terrain);

/// Makes a box fit its terrain, which it places in it: what of the size is not given (0) is as much
/// of the map as whole cells cover, and high enough for what is released; the floor, unless it is
/// given, lies four cells below the lowest ground. Bodies are set to the release where they are
/// it.
void fit_to_terrain(Scene& scene);

/// The surfaces and the ground of the terrain.
std::vector<Surface> rigid_surfaces(const Scene& scene);

/// About how many points a body has: volume_of() over theirs.
double expected_points(const Scene& scene, const Body& body);

/// Points of a body along x, y and z (1 in the plane): its size over point_spacing(), which
/// validate() has found whole.
std::array<std::int64_t, 3> point_lattice(const Scene& scene, const Body& body);

/// Raises the top edge of the box to the next whole cell if it stands on none (the paper's 0.56 m
/// is 89.6 cells). Returns whether it did. The other edges stay: material rests against them.
bool raise_top_to_cells(Scene& scene);

/// The stretch of an inflow along the directions of its edge, its ends set where they were left out
/// [m]; the second is 0 to 1 in the plane.
struct Stretch {
  std::array<double, 2> from{}, to{};
  double area() const { return (to[0] - from[0]) * (to[1] - from[1]); }  ///< [m], in space [m²]
};
Stretch stretch_of(const Scene& scene, const Inflow& inflow);

/// How fast the material of an inflow comes in, whose density is given [m/s].
double speed_of(const Scene& scene, const Inflow& inflow, double density);

/// Checks what no single value can tell: bodies inside the box and not overlapping, h that divides
/// the box, a square points_per_cell, laws that accept their parameters and initial state, nothing
/// that only plane strain has in a scene in space. Throws
/// InputError whose key is a TOML path such as "grid.h", "body[0].size" or "body[1].law.kappa".
void validate(const Scene& scene);

/// Throws InputError where steps of dt would be more than anybody waits for: 1e11 of the smallest
/// scene take days, and what lies beyond is a slip of the pen.
void require_end_in_reach(const Scene& scene, double dt);

}  // namespace repose::mpm
