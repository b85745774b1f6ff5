#pragma once

#include <string>
#include <string_view>

namespace repose::report {

/// gnuplot's SVG with the figure's title as its own, the fonts named once, and without what would
/// tell gnuplot versions apart or label every curve "gnuplot_plot_1" under the mouse.
std::string tidy_svg(std::string svg, std::string_view title);

}  // namespace repose::report
