#include "io/level_lines.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace repose::io {
namespace {

/// A piece of a line in one square, from one edge of the lattice to another, high values on its
/// left in the lattice's own sense.
struct Piece {
  std::size_t from, to;
};

/// The edge from node (i, k) along x, or with `up` along y.
std::size_t edge_id(const Lattice& lattice, std::size_t i, std::size_t k, bool up) {
  return 2 * (k * lattice.columns + i) + (up ? 1 : 0);
}

void pieces_of_square(const Lattice& lattice, std::size_t i, std::size_t k, double level,
                      std::vector<Piece>& pieces) {
  const auto value = [&](std::size_t di, std::size_t dk) {
    return lattice.values[(k + dk) * lattice.columns + i + di];
  };
  // corners and edges counterclockwise from (i, k)
  const std::array<double, 4> corner{value(0, 0), value(1, 0), value(1, 1), value(0, 1)};
  const std::array<std::size_t, 4> edge{
      edge_id(lattice, i, k, false), edge_id(lattice, i + 1, k, true),
      edge_id(lattice, i, k + 1, false), edge_id(lattice, i, k, true)};
  double sum = 0.0;
  for (const double x : corner) sum += x;
  if (!std::isfinite(sum)) return;
  const bool middle_is_high = 0.25 * sum >= level;
  for (std::size_t e = 0; e < 4; ++e) {
    const auto high = [&](std::size_t c) { return corner[c % 4] >= level; };
    if (!high(e) || high(e + 1)) continue;
    // begins where one going around comes down, and ends where one has gone up: the next such
    // place, or if two high corners are apart the one before
    std::size_t end = e;
    do end += middle_is_high ? 1 : 3;
    while (!(!high(end) && high(end + 1)));
    pieces.push_back({edge[e], edge[end % 4]});
  }
}

std::array<double, 2> crossing(const Lattice& lattice, std::size_t id, double level) {
  const std::size_t node = id / 2, i = node % lattice.columns, k = node / lattice.columns;
  const std::size_t next = id % 2 == 1 ? node + lattice.columns : node + 1;
  const double a = lattice.values[node], b = lattice.values[next];
  const double t = std::clamp((level - a) / (b - a), 0.0, 1.0);
  const double di = id % 2 == 1 ? 0.0 : t, dk = id % 2 == 1 ? t : 0.0;
  return {lattice.x + lattice.dx * (static_cast<double>(i) + di),
          lattice.y + lattice.dy * (static_cast<double>(k) + dk)};
}

/// Whether a place lies within a ring: a ray to the right meets it an odd number of times.
bool lies_in(const std::array<double, 2>& x, const Ring& ring) {
  bool inside = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
    if ((ring[i][1] > x[1]) != (ring[j][1] > x[1]) &&
        x[0] < ring[j][0] +
                   (ring[i][0] - ring[j][0]) * (x[1] - ring[j][1]) / (ring[i][1] - ring[j][1]))
      inside = !inside;
  return inside;
}

}  // namespace

double signed_area(const Ring& ring) {
  double twice = 0.0;  // about the first place, for the sake of the last digits
  for (std::size_t i = 2; i < ring.size(); ++i)
    twice += (ring[i - 1][0] - ring[0][0]) * (ring[i][1] - ring[0][1]) -
             (ring[i - 1][1] - ring[0][1]) * (ring[i][0] - ring[0][0]);
  return 0.5 * twice;
}

std::vector<LevelLine> level_lines(const Lattice& lattice, double level) {
  std::vector<Piece> pieces;
  for (std::size_t k = 0; k + 1 < lattice.rows; ++k)
    for (std::size_t i = 0; i + 1 < lattice.columns; ++i)
      pieces_of_square(lattice, i, k, level, pieces);
  // an edge is the beginning of one piece at most, and the end of one
  std::unordered_map<std::size_t, std::size_t> begins;
  std::unordered_map<std::size_t, bool> is_end;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    begins[pieces[p].from] = p;
    is_end[pieces[p].to] = true;
  }
  std::vector<LevelLine> lines;
  std::vector<bool> taken(pieces.size(), false);
  const auto follow = [&](std::size_t first) {
    LevelLine line;
    line.places.push_back(crossing(lattice, pieces[first].from, level));
    for (std::size_t p = first;;) {
      taken[p] = true;
      const auto next = begins.find(pieces[p].to);
      line.closed = next != begins.end() && next->second == first;
      if (line.closed) break;
      line.places.push_back(crossing(lattice, pieces[p].to, level));
      if (next == begins.end()) break;
      p = next->second;
    }
    lines.push_back(std::move(line));
  };
  for (std::size_t p = 0; p < pieces.size(); ++p)  // first those with a beginning of their own
    if (!is_end.contains(pieces[p].from)) follow(p);
  for (std::size_t p = 0; p < pieces.size(); ++p)
    if (!taken[p]) follow(p);
  return lines;
}

std::vector<Region> regions_above(const Lattice& lattice, double level) {
  Lattice padded = lattice;
  padded.columns += 2;
  padded.rows += 2;
  padded.x -= padded.dx;
  padded.y -= padded.dy;
  std::vector<double> values(padded.columns * padded.rows, 0.0);
  for (std::size_t k = 0; k < lattice.rows; ++k)
    for (std::size_t i = 0; i < lattice.columns; ++i) {
      const double x = lattice.values[k * lattice.columns + i];
      values[(k + 1) * padded.columns + i + 1] = std::isnan(x) ? 0.0 : x;
    }
  padded.values = values;
  const bool mirrored = (lattice.dx > 0.0) != (lattice.dy > 0.0);
  std::vector<Region> regions;
  std::vector<Ring> holes;
  for (LevelLine& line : level_lines(padded, level)) {
    if (mirrored) std::reverse(line.places.begin(), line.places.end());
    if (signed_area(line.places) > 0.0)
      regions.push_back({std::move(line.places), {}, {}});
    else
      holes.push_back(std::move(line.places));
  }
  for (Ring& hole : holes) {  // of the smallest ring around it
    Region* around = nullptr;
    for (Region& region : regions)
      if (lies_in(hole.front(), region.outer) &&
          (around == nullptr || signed_area(region.outer) < signed_area(around->outer)))
        around = &region;
    if (around != nullptr) around->holes.push_back(std::move(hole));
  }
  return regions;
}

}  // namespace repose::io
