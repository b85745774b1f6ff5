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
};

/// Does every stage of the path lead to a value of x at a known rate, so that rows can be had at
/// given abscissae?
bool leads_along(const point::Path& path, point::Quantity x);

/// The path with a leg ending at each abscissa; leg_of_row[i] is the leg whose end is abscissa i,
/// −1 for the start itself. x_start: x before the first leg. Errors: InputError (key "data") for an
/// abscissa that the stages do not pass, with its line.
point::Path split_at(const point::Path& path, point::Quantity x, double x_start,
                     std::span<const double> abscissae, std::span<const int> lines,
                     std::vector<int>& leg_of_row);

/// Simple shear at the shear rates given, one row at the end of each (a flow curve).
/// strain: how far each is sheared to become steady.
point::Path flow_curve_path(std::span<const double> shear_rates, point::Condition condition,
                            double strain);

/// The simulator. Inputs: the law's parameters by name, then p, ocr, v, K0, p_c0 of the initial
/// state; NaN for what is absent. Derivatives are exact with the methods adaptive and implicit;
/// `automatic` never takes another one here. Errors: InputError.
std::unique_ptr<Simulator> make_point_simulator(PointExperiment experiment);

}  // namespace repose::calibration
