#pragma once
/// \file
/// Triangles from an STL file, binary or ASCII (M. Burns, Automated Fabrication, 1993, 6.5).

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace repose::io {

/// Corners that are the same to the last digit are one vertex; triangles of which two are the same
/// are left out. Normals that the file gives are passed over: the order of the corners tells.
struct Triangles {
  std::vector<std::array<double, 3>> vertices;  ///< in the file's own lengths
  std::vector<std::array<std::uint32_t, 3>> corners;
};

/// Errors: TableError for a file that is neither, ends early or goes on after its last triangle,
/// has a number that is none or is not finite, or no triangles; with the row of an ASCII file, or
/// the triangle.
Triangles parse_stl(std::string_view bytes, const std::string& name);

}  // namespace repose::io
