#pragma once
/// \file
/// What pictures of a scene show besides its material: the box with its edges, what is rigid, where
/// material comes in, where it is looked at.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mpm/step/simulation.hpp"
#include "report/plot/figure.hpp"

namespace repose::report {

/// The section that a picture shows at a moment: in space the cells from z_m to z_m + depth_m, in
/// the plane all there is.
struct Section {
  double time_s = 0.0;
  double z_m = 0.0, depth_m = 0.0;
  std::vector<mpm::Probe> tracers{};  ///< where their points are
  /// Whether the legend explains what is drawn, and arrows tell what moves.
  bool explained = false;

  double middle() const { return z_m + 0.5 * depth_m; }
  std::string title() const;  ///< ", z = 0 to 0.01 m"; empty in the plane
};

/// In space along z = 0, or in the middle of the box where that is no plane of symmetry. Tracers
/// are where the scene places them.
Section section_of(const mpm::Scene& scene);
/// The same at the simulation's time, with tracers where their points are now, as long as they are
/// in the box.
Section section_of(const mpm::Simulation& simulation);

/// A stretch of the edges left, right, floor and top as a section shows it.
struct EdgeStretch {
  std::size_t edge = 0;  ///< of mpm::edge_names
  mpm::Wall::Kind kind = mpm::Wall::Kind::slip;
  std::array<double, 2> from{}, to{};  ///< (x, y) of its ends [m]
};
/// All of them, one after the other along each edge; neighbours that are both closed are one.
std::vector<EdgeStretch> edge_stretches(const mpm::Scene& scene, double z);

/// What of a body a section at z cuts, as the scene gives it: rigid surfaces aside.
std::vector<mpm::Polygon> outlines_of(const mpm::Body& body, double z);

/// A body with its law: "sand (mu_i)".
std::string name_of(const mpm::Scene& scene, std::size_t body);
/// The colour of a body in pictures where these are told apart.
Colour colour_of_body(std::size_t body);
/// name_of() for a legend no taller than its panel: of many bodies the first, then how many more,
/// then nothing.
std::string legend_name_of(const mpm::Scene& scene, std::size_t body);

/// Bodies by colour: points at (xs, ys) of the bodies whose numbers are in `body`, each a disc of
/// that diameter [m].
void draw_bodies(Axes& axes, const mpm::Scene& scene, std::span<const std::int32_t> body,
                 std::span<const double> xs, std::span<const double> ys, double diameter);

/// A panel for the box of a scene, to scale.
Axes& add_section(Figure& figure, const mpm::Scene& scene);

/// Edges, surfaces, inflows, probes, tracers and gravity.
void draw_surroundings(Axes& axes, const mpm::Scene& scene, const Section& section);

/// An arrow for what comes in between two places, and what it is beside it; length: of the arrow.
void draw_inflow(Axes& axes, const mpm::Scene& scene, const mpm::Inflow& inflow,
                 const std::array<double, 2>& from, const std::array<double, 2>& to,
                 const std::array<double, 2>& inwards, double length, bool explained);

/// A cross with a number at each place, whose names stand in the legend; or where they are tracers
/// rings with their names.
void draw_places(Axes& axes, const std::vector<mpm::Probe>& places, bool tracers);

}  // namespace repose::report
