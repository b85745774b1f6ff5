#pragma once
/// \file
/// A loading path: legs in a row, each one set of constraints with an end. Named laboratory tests
/// (laboratory.hpp) build paths; the integrators know nothing else.

#include <string>
#include <vector>

#include "pointdriver/path/control.hpp"
#include "pointdriver/path/curve.hpp"

namespace repose::point {

/// A quantity reaching a value, from either side.
struct Goal {
  Quantity quantity = Quantity::time;
  double value = 0.0;
  bool of_stage = false;  ///< a strain that counts from the start of its stage, not of the test
  StrainMeasure measure = StrainMeasure::logarithmic;  ///< of a strain located on the way
};

enum class Kind : std::uint8_t { isotropic, oedometer, triaxial, simple_shear, custom };

/// What is kept while the test is driven.
enum class Condition : std::uint8_t {
  drained,                 ///< triaxial: σ_r constant
  undrained,               ///< triaxial: no change of volume
  constant_p,              ///< triaxial, simple shear: mean stress constant
  constant_sigma_a,        ///< triaxial: axial stress constant
  constant_volume,         ///< simple shear
  constant_normal_stress,  ///< simple shear: σ_yy constant
};

/// One leg. It ends after `duration`, or when the goal is reached:
/// - with a goal that the driver row leads to at a known rate (ε_a under a prescribed axial rate, p
///   under a prescribed mean stress rate), the duration follows from the state at its start;
/// - with `goal_is_event`, the goal is located along the way and `strain_limit` bounds the leg.
/// The driver row's rate is given positive; its sign is chosen so as to approach the goal.
struct LegSpec {
  std::array<Constraint, 6> rows{};
  int driver = -1;  ///< row whose sign is chosen; −1: the rows are meant as they are
  std::optional<Goal> goal;
  bool goal_is_event = false;
  bool goal_falls = false;    ///< the goal's quantity falls while the driver row's rate is positive
  double goal_rate = 1.0;     ///< |d goal/dt| while driven (goal not an event) [unit/s]
  double strain_limit = 1.0;  ///< of the driver, for a goal located as an event [-]
  double duration = 0.0;      ///< without goal [s]
  int points = 1;             ///< rows of output, evenly spaced in time
  bool continues = false;    ///< belongs to the stage of the leg before: its strains go on counting
  std::vector<Goal> stops;   ///< conditions that end the whole test
  std::string name;          ///< for messages: "drained extension"
  Kind kind = Kind::custom;  ///< the laboratory's name for it
  Condition condition = Condition::drained;  ///< where the kind has a choice
};

/// A leg with its control prepared for both signs of the driver.
class Leg {
 public:
  /// Errors: InputError (Control; rates, durations and counts that are not positive).
  explicit Leg(LegSpec spec);
  const LegSpec& spec() const { return spec_; }
  /// forward: towards a larger value of the goal.
  const Control& control(bool forward) const { return control_[forward ? 0 : 1]; }

 private:
  LegSpec spec_;
  std::array<Control, 2> control_;
};

/// What a test says about its own start: Σ stress_i σ_i (no sum over strain: that is zero at the
/// start) has this value.
struct StartClaim {
  Constraint of;
  double value = 0.0;      ///< [Pa], or [-] where `of` holds strain
  double tolerance = 0.0;  ///< in the same unit
  std::string column;      ///< for messages
  std::string table;
};

struct Path {
  std::vector<Leg> legs;
  Frame frame = Frame::general;
  StrainMeasure measure = StrainMeasure::logarithmic;  ///< in which strains are read off the curve
  std::vector<StartClaim> start_claims;  ///< of a history in absolute values: its first row
  bool undrained = false;                ///< report u
  int first_undrained = 0;               ///< the leg at whose start the excess pore pressure is 0
  bool wants_strain_rate = false;        ///< rows carry D (for γ̇ and I)
  bool needs_axisymmetry = false;  ///< the initial stress must have σ_xx = σ_zz and no shear
  bool needs_isotropy = false;     ///< the initial stress must be isotropic
  /// Of every leg its stage, from 1, and in a stage of cycles its cycle, from 1 (else 0).
  struct Place {
    int stage = 0, cycle = 0;
  };
  std::vector<Place> places() const;
  /// Upper bound of the number of rows that a completed path writes.
  std::size_t row_count() const;
};

}  // namespace repose::point
