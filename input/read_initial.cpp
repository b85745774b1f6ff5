#include "input/read_initial.hpp"

#include <fmt/core.h>

#include "input/toml_reader.hpp"

namespace repose::input {

void initial_keys(Keys& keys, InitialConditions& initial) {
  constexpr Range from_one{1.0, 1e6, false, false};
  constexpr Range ratio{0.0, 1e3, true, false};
  keys.number({"p", "Pa", "mean pressure"}, initial.p);
  keys.number({"sigma_v", "Pa", "vertical stress, with K0, in place of p", positive},
              initial.sigma_v);
  keys.number({"ocr", "-", "overconsolidation ratio p_c/p, of mean stresses", from_one},
              initial.ocr);
  keys.number(
      {"ocr_v", "-", "overconsolidation ratio of vertical stresses, sigma_v,max/sigma_v", from_one},
      initial.ocr_v);
  keys.number({"K0_nc", "-", "ratio of radial to axial stress at sigma_v,max (default: K0)", ratio},
              initial.K0_nc);
  keys.number({"v", "-", "specific volume", Range{1.0, 1e3, true, false}}, initial.v);
  std::optional<double> void_ratio;
  keys.number({"e", "-", "void ratio, in place of v = 1 + e", ratio}, void_ratio);
  if (void_ratio) {
    if (TomlReader* const table = keys.reader(); table != nullptr && initial.v)
      table->report("e", fmt::format("{}: give either e or v = 1 + e", table->path_of("e")));
    initial.v = 1.0 + *void_ratio;
  }
  keys.number({"density", "kg/m³", "density", positive}, initial.density);
  keys.number({"K0", "-", "ratio of radial (horizontal) to axial (vertical) stress", ratio},
              initial.K0);
  keys.components({"sigma", "Pa", "xx, yy, zz, xy, yz, zx, compression positive"}, initial.sigma);
}

}  // namespace repose::input
