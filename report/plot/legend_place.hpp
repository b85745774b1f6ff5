#pragma once

#include "report/plot/figure_layout.hpp"

namespace repose::report {

/// Decides where a panel's legend goes, given its ranges and the size of its area: inside, relative
/// to the area's own upper left corner for now, or beside it. Leaves the panel without one if no
/// series has a name.
void place_legend(PanelView& panel, const Axes& axes);

}  // namespace repose::report
