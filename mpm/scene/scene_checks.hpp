#pragma once
/// \file
/// The checks of validate(), in several files: what they say numbers and keys with, and those of
/// shapes. Each throws InputError, with the key as in a scene's file.

#include <cmath>
#include <cstdio>
#include <string>

#include "mpm/scene/scene.hpp"

namespace repose::mpm {

inline std::string number(double x, int digits = 10) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, x);
  return text;
}

inline std::string path_of(std::size_t body, const char* key) {
  return "body[" + std::to_string(body) + "]." + key;
}

inline void require(double x, const Range& range, const char* key, const char* what) {
  if (std::isfinite(x) && range.contains(x)) return;
  throw InputError(
      key, std::string(what) + " = " + number(x) + " is out of range: must be " + to_string(range));
}

/// Bodies that are cut by their surfaces.
void check_solids(const Scene& scene);
void check_discs(const Scene& scene);
void check_polygons(const Scene& scene);
void check_overlap(const Scene& scene);
void check_surfaces(const Scene& scene);

}  // namespace repose::mpm
