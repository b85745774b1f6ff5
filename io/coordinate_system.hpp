#pragma once
/// \file
/// Coordinate systems of maps in well-known text, WKT 1 or 2 (ISO 19162), as in a .prj file.

#include <string>
#include <string_view>

namespace repose::io {

/// Why lengths and heights of a map in this system are no metres: "its places are in degrees
/// (WGS 84)", "its heights are in foot, 0.3048 m". Empty where they are, or where the text does not
/// tell.
std::string why_not_metres(std::string_view wkt);

/// "32632", the number that EPSG knows the system by, of one with heights that of its plane; empty
/// if the text does not tell.
std::string epsg_of(std::string_view wkt);

}  // namespace repose::io
