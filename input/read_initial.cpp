#include "input/read_initial.hpp"

namespace repose::input {

void initial_keys(Keys& keys, InitialConditions& initial) {
  keys.number({"p", "Pa", "mean pressure"}, initial.p);
  keys.number(
      {"ocr", "-", "overconsolidation ratio p_c/p", Range{1.0, positive.upper, false, true}},
      initial.ocr);
  keys.number({"v", "-", "specific volume", Range{1.0, positive.upper}}, initial.v);
  keys.number({"density", "kg/m³", "density", positive}, initial.density);
  keys.number({"K0", "-", "ratio of horizontal (radial) to vertical (axial) stress", positive},
              initial.K0);
  keys.components({"sigma", "Pa", "xx, yy, zz, xy, yz, zx, compression positive"}, initial.sigma);
}

}  // namespace repose::input
