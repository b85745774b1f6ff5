#pragma once
/// \file
/// The pictures of `repose chart mpm`. A transfer keeps its colour and marker in all of them; one
/// column of panels per cell size and kernel.

#include "report/plot/figure.hpp"
#include "study/accuracy/errors.hpp"

namespace repose::report {

/// Over the mean step: front, height, kinetic energy at the end; and the profile's change from the
/// shortest step over CPU seconds (work and precision).
Figure step_figure(const std::vector<study::SweepSeries>& series, const std::string& name);

/// Front and kinetic energy over time: the longest step dashed, the shortest solid.
Figure history_figure(const std::vector<study::SweepSeries>& series, const std::string& name);

/// CPU seconds over the cell size with the slope h^-3 of a fixed scene, speed and memory over the
/// number of points; one line per transfer, kernel and step. For several cell sizes.
Figure cost_figure(const std::vector<study::SweepSeries>& series, const std::string& name);

/// Work and precision: error of every run over its CPU seconds, a panel per quantity that has a
/// reference and one for the energy ledger. A line joins the runs of a transfer, kernel and points
/// per cell at its longest step over the cells, dots are its other steps; rings mark the Pareto
/// front, the grey band is below the error bar of the reference.
Figure work_precision_figure(std::span<const study::SweepRun> runs,
                             const study::SweepReference& reference, const std::string& name);

/// Of a flow with an exact solution: momentum and kinetic energy over time, and their errors over
/// the cell size.
Figure flow_figure(std::span<const study::SweepRun> runs, const study::SweepReference& reference,
                   const std::string& name);

}  // namespace repose::report
