// Any bytes as the file of a shape: it is read or refused with a TableError, and what was read has
// distances that are numbers. The first byte chooses between an STL file, a closed curve and an
// open one; the rest is the file.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "input/read_surface.hpp"
#include "io/table_error.hpp"

namespace {

using namespace repose;

void require(bool holds) {
  if (!holds) std::abort();
}

/// Of coordinates so large that their squares overflow nothing is asked.
constexpr double most = 1e60;

/// The distance from some places is one, and changes by no more than the way between them.
void require_distance(const mpm::Solid& solid, const mpm::Position& low,
                      const mpm::Position& high) {
  double size = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(std::abs(low[k]) < most && std::abs(high[k]) < most)) return;
    size = std::max({size, std::abs(low[k]), std::abs(high[k])});
  }
  double before = 0.0;
  mpm::Position last{};
  for (int n = 0; n <= 8; ++n) {
    mpm::Position x{};
    double way = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = low[k] + (high[k] - low[k]) * (n * static_cast<double>(k + 3) / 30.0);
      way = std::hypot(way, x[k] - last[k]);
    }
    const double distance = nearest(solid, x).distance;
    require(std::isfinite(distance));
    if (n > 0) require(std::abs(std::abs(distance) - std::abs(before)) <= way + 1e-6 * size);
    before = distance;
    last = x;
  }
}

void read_mesh(const std::string& bytes) {
  mpm::Mesh mesh;
  mesh.mesh = input::mesh_of(bytes, "f", mesh);
  require(mesh.mesh->size() > 3 && mesh.mesh->volume() > 0.0);
  const auto& [low, high] = mesh.mesh->bounds();
  require_distance({mesh, false}, low, high);
  require(mesh.mesh->crossings(0.5 * (low[0] + high[0]), 0.5 * (low[2] + high[2])).size() % 2 == 0);
}

void read_curve(const std::string& bytes, bool closed) {
  mpm::Curve curve;
  curve.line = input::line_of(bytes, "f", curve, closed);
  require(curve.line->points().size() > (closed ? 2U : 1U));
  mpm::Position low{HUGE_VAL, HUGE_VAL, 0.0}, high{-HUGE_VAL, -HUGE_VAL, 0.0};
  for (const auto& point : curve.line->points())
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], point[k]);
      high[k] = std::max(high[k], point[k]);
    }
  require_distance({curve, false}, low, high);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    if (data[0] % 3 == 0)
      read_mesh(bytes);
    else
      read_curve(bytes, data[0] % 3 == 1);
  } catch (const io::TableError& error) {
    require(!error.cause().empty());
  }
  return 0;
}
