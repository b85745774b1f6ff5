#pragma once
/// \file
/// What a collapse is asked for, and what one run says of it.

#include <array>
#include <optional>
#include <string_view>

#include <Eigen/Core>

#include "study/accuracy/sweep.hpp"

namespace repose::study {

enum class Quantity {
  front,     ///< front_m at the end
  front_99,  ///< front_99_m at the end
  height,    ///< height_m at the end
  profile,   ///< depth over x at the end
  kinetic,   ///< kinetic energy over time
  momentum,  ///< momentum along x over time
};
/// Their names, in the same order.
constexpr std::array<std::string_view, 6> quantity_names{"front",   "front_99", "height",
                                                         "profile", "kinetic",  "momentum"};
constexpr std::size_t quantity_count = quantity_names.size();
/// Those whose error model is known, so that --accuracy can be asked for them; the first of all.
constexpr std::array<std::string_view, 5> advised_names{"front", "front_99", "height", "profile",
                                                        "kinetic"};
constexpr std::string_view name_of(Quantity q) {
  return quantity_names[static_cast<std::size_t>(q)];
}
/// Is it a curve rather than a number?
constexpr bool is_curve(Quantity q) { return q >= Quantity::profile; }
/// "front_m", "m": the figure of summary.json that a number is, and its unit; a curve's column.
std::string_view column_of(Quantity q, std::size_t dimensions = 2);
std::string_view unit_of(Quantity q, std::size_t dimensions);

/// A run's quantity as shares (study/accuracy/richardson.hpp), comparable between runs of one scene
/// with any cells: a number as it is; a profile as the volumes [m³ per m] of columns of width `bin`
/// [m]; energy and momentum times the time between rows [J s, kg m per m]. The run must be done.
Eigen::VectorXd shares_of(const SweepRun& run, Quantity q, double bin);

/// The shares at the start of a run; absent for curves over time, and for profiles in space.
std::optional<Eigen::VectorXd> start_of(const SweepRun& run, Quantity q, double bin);

/// Places and heights of the curve that shares are: x [m] and depth [m], or time [s] and energy
/// [J/m] or momentum [kg m/s per m].
struct QuantityCurve {
  std::vector<double> x, y;
};
QuantityCurve curve_of(const Eigen::VectorXd& shares, Quantity q, const mpm::Scene& scene,
                       double bin);

/// √(area of the bodies) [m]: the length that cells are measured by.
double length_of(const mpm::Scene& scene);

}  // namespace repose::study
