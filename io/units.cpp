#include "io/units.hpp"

#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "io/number_text.hpp"

namespace repose::io {
namespace {

namespace dim = dimension;

struct KnownUnit {
  std::string_view name;
  double factor;
  Dimension dimension;
  bool in_lists = false;  ///< named in messages
};

// Exact by definition (SI brochure, 9th edition; NIST SP 811, appendix B for inch, pound and foot):
constexpr double g = 9.80665;             // [m/s²]
constexpr double inch = 0.0254;           // [m]
constexpr double pound = 0.45359237 * g;  // pound-force [N]
constexpr double psi = pound / (inch * inch);
constexpr double degree = 0.017453292519943295;  // π/180

constexpr auto known_units = std::to_array<KnownUnit>({
    {"-", 1.0, dim::number, true},
    {"1", 1.0, dim::number},
    {"none", 1.0, dim::number},
    {"%", 1e-2, dim::number, true},
    {"pct", 1e-2, dim::number},
    {"percent", 1e-2, dim::number},
    {"prozent", 1e-2, dim::number},
    {"permil", 1e-3, dim::number, true},
    {"permille", 1e-3, dim::number},
    {"millistrain", 1e-3, dim::number},
    {"microstrain", 1e-6, dim::number, true},
    {"ue", 1e-6, dim::number},
    {"ueps", 1e-6, dim::number},
    {"ustrain", 1e-6, dim::number},
    {"ppm", 1e-6, dim::number},
    {"m", 1.0, dim::length, true},
    {"km", 1e3, dim::length},
    {"dm", 1e-1, dim::length},
    {"cm", 1e-2, dim::length, true},
    {"mm", 1e-3, dim::length, true},
    {"um", 1e-6, dim::length, true},
    {"micron", 1e-6, dim::length},
    {"microns", 1e-6, dim::length},
    {"nm", 1e-9, dim::length},
    {"in", inch, dim::length, true},
    {"inch", inch, dim::length},
    {"ft", 12 * inch, dim::length, true},
    {"m2", 1.0, dim::area, true},
    {"cm2", 1e-4, dim::area, true},
    {"mm2", 1e-6, dim::area, true},
    {"ft2", 144 * inch* inch, dim::area},
    {"in2", inch* inch, dim::area},
    {"m3", 1.0, dim::volume, true},
    {"cm3", 1e-6, dim::volume, true},
    {"cc", 1e-6, dim::volume},
    {"mm3", 1e-9, dim::volume, true},
    {"l", 1e-3, dim::volume, true},
    {"ml", 1e-6, dim::volume, true},
    {"kg", 1.0, dim::mass, true},
    {"g", 1e-3, dim::mass, true},
    {"mg", 1e-6, dim::mass},
    {"Mg", 1e3, dim::mass},
    {"t", 1e3, dim::mass, true},
    {"s", 1.0, dim::time, true},
    {"sec", 1.0, dim::time},
    {"second", 1.0, dim::time},
    {"seconds", 1.0, dim::time},
    {"ms", 1e-3, dim::time},
    {"min", 60.0, dim::time, true},
    {"mins", 60.0, dim::time},
    {"minute", 60.0, dim::time},
    {"minutes", 60.0, dim::time},
    {"h", 3600.0, dim::time, true},
    {"hr", 3600.0, dim::time},
    {"hrs", 3600.0, dim::time},
    {"hour", 3600.0, dim::time},
    {"hours", 3600.0, dim::time},
    {"d", 86400.0, dim::time, true},
    {"day", 86400.0, dim::time},
    {"days", 86400.0, dim::time},
    {"rad", 1.0, dim::angle, true},
    {"mrad", 1e-3, dim::angle},
    {"deg", degree, dim::angle, true},
    {"degree", degree, dim::angle},
    {"degrees", degree, dim::angle},
    {"Hz", 1.0, dim::rate},
    {"s-1", 1.0, dim::rate},
    {"min-1", 1.0 / 60.0, dim::rate},
    {"h-1", 1.0 / 3600.0, dim::rate},
    {"1/s", 1.0, dim::rate, true},
    {"1/min", 1.0 / 60.0, dim::rate, true},
    {"1/h", 1.0 / 3600.0, dim::rate, true},
    {"1/d", 1.0 / 86400.0, dim::rate, true},
    {"%/s", 1e-2, dim::rate, true},
    {"%/min", 1e-2 / 60.0, dim::rate, true},
    {"%/h", 1e-2 / 3600.0, dim::rate, true},
    {"%/d", 1e-2 / 86400.0, dim::rate, true},
    {"m/s", 1.0, dim::velocity, true},
    {"mm/s", 1e-3, dim::velocity, true},
    {"mm/min", 1e-3 / 60.0, dim::velocity, true},
    {"mm/h", 1e-3 / 3600.0, dim::velocity, true},
    {"kg/m3", 1.0, dim::density, true},
    {"g/cm3", 1e3, dim::density, true},
    {"t/m3", 1e3, dim::density, true},
    {"N", 1.0, dim::force, true},
    {"kN", 1e3, dim::force, true},
    {"MN", 1e6, dim::force},
    {"kgf", g, dim::force, true},
    {"kp", g, dim::force},
    {"tf", 1e3 * g, dim::force},
    {"lbf", pound, dim::force},
    {"J/m", 1.0, dim::energy_per_length},
    {"Pa", 1.0, dim::stress, true},
    {"hPa", 1e2, dim::stress},
    {"kPa", 1e3, dim::stress, true},
    {"MPa", 1e6, dim::stress, true},
    {"GPa", 1e9, dim::stress, true},
    {"kN/m2", 1e3, dim::stress, true},
    {"MN/m2", 1e6, dim::stress},
    {"N/mm2", 1e6, dim::stress, true},
    {"bar", 1e5, dim::stress, true},
    {"mbar", 1e2, dim::stress},
    {"atm", 101325.0, dim::stress},
    {"psi", psi, dim::stress, true},
    {"ksi", 1e3 * psi, dim::stress},
    {"psf", pound / (144 * inch * inch), dim::stress},
    {"ksf", 1e3 * pound / (144 * inch * inch), dim::stress},
    {"tsf", 2e3 * pound / (144 * inch * inch), dim::stress},
    {"kgf/cm2", 1e4 * g, dim::stress, true},
    {"kg/cm2", 1e4 * g, dim::stress},  // in a soil laboratory's table a stress
    {"ksc", 1e4 * g, dim::stress},
    {"at", 1e4 * g, dim::stress},
    {"t/m2", 1e3 * g, dim::stress, true},
    {"Pa/s", 1.0, dim::stress_rate, true},
    {"kPa/s", 1e3, dim::stress_rate, true},
    {"kPa/min", 1e3 / 60.0, dim::stress_rate, true},
    {"kPa/h", 1e3 / 3600.0, dim::stress_rate, true},
});

struct Spelling {
  std::string_view from, to;
};
constexpr auto spellings = std::to_array<Spelling>({
    {"\u00B2", "2"},   {"\u00B3", "3"}, {"\u207B\u00B9", "-1"}, {"\u00B9", "1"},
    {"\u00B5", "u"},   {"\u03BC", "u"}, {"\u03B5", "e"},        {"\u2030", "permil"},
    {"\u00B0", "deg"}, {"\u2212", "-"}, {"\u2013", "-"},        {"\u2215", "/"},
    {"^", ""},         {" ", ""},       {"\u00A0", ""},         {"\u202F", ""},
    {"\u2009", ""},    {"\t", ""},      {"_per_", "/"},         {"per_", "1/"},
});

/// "[ kN/m² ]" → "kN/m2": one spelling in ASCII for each unit.
std::string plain(std::string_view text) {
  text = trimmed(text);
  constexpr auto brackets = std::to_array<std::string_view>({"[]", "()", "{}", "<>"});
  for (const std::string_view pair : brackets)
    if (text.size() >= 2 && text.front() == pair[0] && text.back() == pair[1]) {
      text = trimmed(text.substr(1, text.size() - 2));
      break;
    }
  std::string result;
  while (!text.empty()) {
    std::size_t taken = 0;
    for (const Spelling& s : spellings)
      if (text.starts_with(s.from)) {
        result += s.to;
        taken = s.from.size();
        break;
      }
    if (taken == 0) {
      result += text.front();
      taken = 1;
    }
    text.remove_prefix(taken);
  }
  return result;
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool same_letters(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

/// Does letter case matter? milli and mega are one letter, and so are whole units.
bool case_decides(std::string_view text, std::string_view known) {
  if (text.size() < 2) return true;
  const char first = text.front(), wanted = known.front();
  return (first == 'm' || first == 'M') && first != wanted;
}

std::optional<Unit> find_simple(std::string_view text) {
  for (const KnownUnit& unit : known_units)
    if (unit.name == text) return Unit{unit.factor, unit.dimension};
  for (const KnownUnit& unit : known_units)
    if (same_letters(unit.name, text) && !case_decides(text, unit.name))
      return Unit{unit.factor, unit.dimension};
  return {};
}

}  // namespace

std::optional<Unit> find_unit(std::string_view text) {
  if (text.size() > 40) return {};
  const std::string unit = plain(text);
  if (const auto simple = find_simple(unit)) return simple;
  const std::size_t slash = unit.rfind('/');
  if (slash == std::string::npos) return {};
  const auto below = find_simple(std::string_view(unit).substr(slash + 1));
  auto above = slash == 0 ? std::optional<Unit>(Unit{})
                          : find_simple(std::string_view(unit).substr(0, slash));
  if (!above || !below || below->dimension == dim::number) return {};
  const auto minus = [](std::int8_t a, std::int8_t b) { return static_cast<std::int8_t>(a - b); };
  const Dimension a = above->dimension, b = below->dimension;
  return Unit{above->factor / below->factor,
              {minus(a.m, b.m), minus(a.kg, b.kg), minus(a.s, b.s), minus(a.rad, b.rad)}};
}

std::vector<std::string> unit_names(std::optional<Dimension> dimension) {
  std::vector<std::string> names;
  for (const KnownUnit& unit : known_units)
    if (unit.in_lists && (!dimension || unit.dimension == *dimension))
      names.emplace_back(unit.name);
  return names;
}

std::string name_of(Dimension dimension) {
  if (dimension == dim::number) return "a number without dimension (a strain, a void ratio)";
  if (dimension == dim::length) return "a length";
  if (dimension == dim::area) return "an area";
  if (dimension == dim::volume) return "a volume";
  if (dimension == dim::mass) return "a mass";
  if (dimension == dim::time) return "a time";
  if (dimension == dim::angle) return "an angle";
  if (dimension == dim::rate) return "a rate (per time)";
  if (dimension == dim::velocity) return "a velocity";
  if (dimension == dim::density) return "a density";
  if (dimension == dim::force) return "a force";
  if (dimension == dim::stress) return "a stress";
  if (dimension == dim::stress_rate) return "a stress rate";
  return fmt::format("a quantity in m^{} kg^{} s^{} rad^{}", dimension.m, dimension.kg, dimension.s,
                     dimension.rad);
}

}  // namespace repose::io
