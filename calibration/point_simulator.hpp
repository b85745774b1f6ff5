#pragma once
/// \file
/// The point driver as a simulator: one law, one laboratory test.

#include <memory>

#include "calibration/simulator.hpp"
#include "pointdriver/integrate/simulate.hpp"

namespace repose::calibration {

/// Where rows are wanted.
enum class Rows : std::uint8_t {
  at_data,   ///< exactly at the experiment's abscissae: the path is split there, nothing
             ///< interpolated
  leg_ends,  ///< at the end of every stage, one per row of the data (flow curves)
  along      ///< the test's own rows
};

struct PointExperiment {
  const LawInfo* law = nullptr;
  std::vector<double> theta;  ///< parameters in table order; NaN where free or absent
  point::PointTest test;
  point::Quantity x = point::Quantity::eps_a;
  std::vector<point::Quantity> y;
  Rows rows = Rows::at_data;
  std::vector<double> abscissae;  ///< of the data, in the order of the test (rows = at_data)
  std::vector<int> lines;         ///< where each stands, for messages; may be empty
  bool start_moves = false;       ///< the initial stress depends on what is fitted
};

/// Does every stage of the path lead to a value of x at a known rate, so that rows can be had at
/// given abscissae?
bool leads_along(const point::Path& path, point::Quantity x);

/// The path with a leg ending at each abscissa; leg_of_row[i] is the leg whose end is abscissa i,
/// −1 for the start itself. x_start: x before the first leg; nullopt where it depends on what is
/// fitted: the first abscissa then has a leg of its own, whichever way that leads. A row that steps
/// back by less than a hundredth of the range of x before the rows go on is scatter of the reading
/// and not a reversal: it is compared at its own x (before the start: with the start). Errors:
/// InputError (key "data") for an abscissa that the stages do not pass, with its line.
point::Path split_at(const point::Path& path, point::Quantity x, std::optional<double> x_start,
                     std::span<const double> abscissae, std::span<const int> lines,
                     std::vector<int>& leg_of_row);

/// Where the rows contradict stages whose strains count from their own start, and agree with the
/// same numbers counted from the start of the test, takes them so and returns true. The rows of a
/// measured table say where a test turned, so there is no doubt which was meant.
bool take_stage_strains_as_totals(PointExperiment& experiment);

/// Simple shear at the shear rates given, one row at the end of each (a flow curve).
/// strain: how far each is sheared to become steady.
point::Path flow_curve_path(std::span<const double> shear_rates, point::Condition condition,
                            double strain);

/// The simulator. Inputs: the law's parameters by name, then p, ocr, v, K0, p_c0 of the initial
/// state; NaN for what is absent. Derivatives are exact with the methods adaptive and implicit;
/// `automatic` never takes another one here. Errors: InputError.
std::unique_ptr<Simulator> make_point_simulator(PointExperiment experiment);

}  // namespace repose::calibration
