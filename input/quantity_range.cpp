#include "input/quantity_range.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace repose::input {
namespace {

// Far outside of what anybody models, and far inside of what doubles hold: a product of three of
// these, or a quotient, overflows nowhere.
constexpr std::array sizes{
    SensibleSize{"m", 1e-9, 1e6},       // an atom's neighbourhood to a landslide's country
    SensibleSize{"s", 1e-12, 1e12},     // a sound wave's step to 30 000 years
    SensibleSize{"Pa", 1e-9, 1e15},     // dust in vacuo to a thousand times diamond
    SensibleSize{"Pa s", 1e-12, 1e15},  // glaciers have 1e13
    SensibleSize{"Pa/s", 1e-20, 1e20}, SensibleSize{"1/Pa", 1e-20, 1e12},
    SensibleSize{"1/s", 1e-18, 1e12},  SensibleSize{"kg/m³", 1e-6, 1e6},
    SensibleSize{"m/s", 1e-12, 1e6},   SensibleSize{"m/s²", 1e-12, 1e6},
    SensibleSize{"rad/s", 1e-12, 1e9}, SensibleSize{"°", 1e-9, 360.0},
    SensibleSize{"-", 1e-18, 1e18},
};

}  // namespace

const SensibleSize* find_sensible_size(std::string_view unit) {
  for (const SensibleSize& size : sizes)
    if (size.unit == unit) return &size;
  return nullptr;
}

std::string why_senseless(double x, std::string_view unit, const Range& range) {
  const SensibleSize* const size = find_sensible_size(unit);
  if (size == nullptr) return "";
  const bool zero_excluded = !range.contains(0.0);
  const bool small = zero_excluded && std::abs(x) < size->smallest;
  if (!small && std::abs(x) <= size->largest) return "";
  char text[120];
  const std::string of = unit == "-" ? "" : " " + std::string(unit);
  std::snprintf(text, sizeof text, "numbers here go %s%g%s%s", small ? "from " : "up to ",
                small ? size->smallest : size->largest, of.c_str(),
                small ? "" : ", whatever their sign");
  return text;
}

}  // namespace repose::input
