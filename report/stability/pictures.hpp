#pragma once
/// \file
/// The pictures of `repose stability`: one for every table of a part's maps, in their order.

#include <vector>

#include "report/plot/figure.hpp"
#include "study/stability/clay.hpp"
#include "study/stability/collapse.hpp"
#include "study/stability/mpm.hpp"
#include "study/stability/mu_i.hpp"
#include "study/stability/step.hpp"

namespace repose::report {

std::vector<Figure> clay_figures(const study::ClayMaps& maps);
std::vector<Figure> mu_i_figures(const study::GrainMaps& maps);
/// Of mu_i_figures(): those of the shear cell.
std::vector<Figure> shear_cell_figures(const study::ShearCellMaps& maps);
std::vector<Figure> step_figures(const study::StepMaps& maps);
std::vector<Figure> mpm_figures(const study::FailureMaps& maps);
std::vector<Figure> collapse_figures(const study::CollapseMaps& maps);

}  // namespace repose::report
