#pragma once
/// \file
/// Units as laboratories write them, and their factors to SI.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace repose::io {

/// Exponents of metre, kilogram, second and radian. Strain, void ratio and the like have none.
struct Dimension {
  std::int8_t m = 0, kg = 0, s = 0, rad = 0;
  bool operator==(const Dimension&) const = default;
};
namespace dimension {
inline constexpr Dimension number{};
inline constexpr Dimension length{1, 0, 0, 0};
inline constexpr Dimension area{2, 0, 0, 0};
inline constexpr Dimension volume{3, 0, 0, 0};
inline constexpr Dimension mass{0, 1, 0, 0};
inline constexpr Dimension time{0, 0, 1, 0};
inline constexpr Dimension angle{0, 0, 0, 1};
inline constexpr Dimension rate{0, 0, -1, 0};
inline constexpr Dimension velocity{1, 0, -1, 0};
inline constexpr Dimension density{-3, 1, 0, 0};
inline constexpr Dimension force{1, 1, -2, 0};
inline constexpr Dimension stress{-1, 1, -2, 0};
inline constexpr Dimension stress_rate{-1, 1, -3, 0};
inline constexpr Dimension energy_per_length{1, 1, -2, 0};  // as a force
}  // namespace dimension

/// "a stress", "a number without dimension (a strain, a void ratio)".
std::string name_of(Dimension dimension);

struct Unit {
  double factor = 1.0;  ///< value in SI = factor × value in this unit
  Dimension dimension;
};

/// "kPa", "[kN/m²]", "(%)", "‰", "µε", "kgf/cm²", "1/min", "%/h", "mm/min", "-", "deg", ...:
/// brackets and blanks around it do not count, nor does letter case where it leaves no doubt (mPa
/// and MPa are not the same). Quotients A/B are put together from known units. None if it is not
/// known.
std::optional<Unit> find_unit(std::string_view text);

/// Common units of a dimension as a user may write them, for messages; of all, if none is given.
std::vector<std::string> unit_names(std::optional<Dimension> dimension = {});

}  // namespace repose::io
