#pragma once
/// \file
/// The axes on which the targets of a fit are drawn.

#include "calibration/target.hpp"
#include "report/plot/figure.hpp"

namespace repose::report {

/// A column's name in a picture and the factor from SI: "q_Pa" → ("q (kPa)", 1e-3).
/// strain: which strain a strain is.
std::pair<std::string, double> column_label(const std::string& column, const std::string& strain);

/// Strains, times and places are read evenly; pressures, rates and inertial numbers by decades.
AxisScale scale_over(const calibration::Target& target);

std::vector<double> scaled(const Eigen::VectorXd& v, double factor);

}  // namespace repose::report
