#pragma once
/// \file
/// The named laboratory tests as paths. Axial = y. Every stage of a test is a LegSpec; a stage says
/// how the boundary is kept (condition), what drives it (strain or stress) and when it ends.

#include <string>

#include "pointdriver/path/path.hpp"
#include "pointdriver/path/settings.hpp"

namespace repose::point {

enum class Drive : std::uint8_t {
  strain,      ///< at a strain rate
  stress,      ///< at a stress rate
  creep,       ///< stresses held (what the condition does not hold otherwise)
  relaxation,  ///< all strains held
};

/// One stage. Goals: eps_a, q, sigma_a, p, gamma, tau, eps_v or any other quantity; those that the
/// driver leads to at a known rate end the stage on time, the others are located on the way.
struct Stage {
  Kind kind = Kind::triaxial;
  Condition condition = Condition::drained;
  Drive drive = Drive::strain;
  std::optional<Goal> goal;
  double rate = 1e-4;         ///< 1/s: axial, volumetric (isotropic) or shear strain γ
  double stress_rate = 1e3;   ///< Pa/s
  double duration = 0.0;      ///< s: creep, relaxation
  double strain_limit = 1.0;  ///< bound while a goal is looked for
  int points = 200;
  std::vector<Goal> stops;
  bool continues = false;  ///< strains go on counting from the start of the stage before
};

/// The leg of a stage. Errors: InputError for combinations that make no test.
LegSpec leg_of(const Stage& stage);

/// A path of stages. Frame, pore pressure and checks of the start follow from the first stage's
/// kind; stages of another kind may follow (isotropic consolidation, then shear).
Path path_of(const std::vector<Stage>& stages);

/// n cycles between two values of a quantity: n times (upper, lower). All half cycles are one
/// stage: with `of_stage`, limits that are strains count from where the cycles began, as a gauge
/// that is set to zero before the first one shows them.
std::vector<Stage> cycles(const Stage& half, Quantity quantity, double lower, double upper, int n,
                          bool of_stage = false);

/// Simple shear at `count` rates spaced evenly in the logarithm, each for `shear_strain`, one row
/// per rate at its end.
std::vector<Stage> rate_sweep(Stage shear, double slowest, double fastest, int count,
                              double shear_strain);

/// A custom path: six rows per leg, as they are.
Path custom_path(std::vector<LegSpec> legs);

std::string_view name_of(Kind kind);
std::string_view name_of(Condition condition);

}  // namespace repose::point
