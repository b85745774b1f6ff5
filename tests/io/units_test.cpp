// Units of laboratories: factors by definition, spellings, and what a header says.
#include "io/units.hpp"

#include <gtest/gtest.h>

#include "io/column_header.hpp"
#include "io/number_text.hpp"

namespace repose::io {
namespace {

namespace dim = dimension;

TEST(Units, factors_and_spellings) {
  struct Case {
    const char* text;
    double factor;
    Dimension dimension;
  };
  // kgf = 9.80665 N, lbf = 0.45359237 kg × 9.80665 m/s², in = 25.4 mm, all exact (SP 811)
  const double psi = 0.45359237 * 9.80665 / (0.0254 * 0.0254);
  const std::vector<Case> cases{{"Pa", 1, dim::stress},
                                {"kPa", 1e3, dim::stress},
                                {"[kPa]", 1e3, dim::stress},
                                {"( kpa )", 1e3, dim::stress},
                                {"MPa", 1e6, dim::stress},
                                {"GPa", 1e9, dim::stress},
                                {"bar", 1e5, dim::stress},
                                {"psi", psi, dim::stress},
                                {"kN/m\u00B2", 1e3, dim::stress},
                                {"KN/m2", 1e3, dim::stress},
                                {"kN/m^2", 1e3, dim::stress},
                                {"N/mm\u00B2", 1e6, dim::stress},
                                {"kgf/cm\u00B2", 98066.5, dim::stress},
                                {"kg/cm2", 98066.5, dim::stress},
                                {"t/m\u00B2", 9806.65, dim::stress},
                                {"tf/m2", 9806.65, dim::stress},
                                {"lbf/ft2", 144 * psi / 20736, dim::stress},
                                {"-", 1, dim::number},
                                {"[-]", 1, dim::number},
                                {"1", 1, dim::number},
                                {"%", 1e-2, dim::number},
                                {"pct", 1e-2, dim::number},
                                {"\u2030", 1e-3, dim::number},
                                {"mm/mm", 1, dim::number},
                                {"m/m", 1, dim::number},
                                {"\u00B5\u03B5", 1e-6, dim::number},
                                {"\u03BC\u03B5", 1e-6, dim::number},
                                {"microstrain", 1e-6, dim::number},
                                {"mm/m", 1e-3, dim::number},
                                {"m", 1, dim::length},
                                {"mm", 1e-3, dim::length},
                                {"cm", 1e-2, dim::length},
                                {"\u00B5m", 1e-6, dim::length},
                                {"s", 1, dim::time},
                                {"Sec", 1, dim::time},
                                {"min", 60, dim::time},
                                {"h", 3600, dim::time},
                                {"d", 86400, dim::time},
                                {"deg", 3.14159265358979323846 / 180, dim::angle},
                                {"\u00B0", 3.14159265358979323846 / 180, dim::angle},
                                {"rad", 1, dim::angle},
                                {"1/s", 1, dim::rate},
                                {"/s", 1, dim::rate},
                                {"s\u207B\u00B9", 1, dim::rate},
                                {"per_s", 1, dim::rate},
                                {"1/min", 1.0 / 60, dim::rate},
                                {"%/h", 1e-2 / 3600, dim::rate},
                                {"%/min", 1e-2 / 60, dim::rate},
                                {"pct_per_min", 1e-2 / 60, dim::rate},
                                {"mm/min", 1e-3 / 60, dim::velocity},
                                {"kg/m\u00B3", 1, dim::density},
                                {"g/cm3", 1e3, dim::density},
                                {"kPa/min", 1e3 / 60, dim::stress_rate},
                                {"kN", 1e3, dim::force},
                                {"ml", 1e-6, dim::volume},
                                {"cm\u00B3", 1e-6, dim::volume}};
  for (const Case& c : cases) {
    const auto unit = find_unit(c.text);
    ASSERT_TRUE(unit) << c.text;
    // products and quotients of up to four rounded factors: 4 ulp
    EXPECT_NEAR(unit->factor / c.factor, 1.0, 4 * 2.3e-16) << c.text;
    EXPECT_EQ(unit->dimension, c.dimension) << c.text;
  }
  for (const char* unknown : {"", "mPa", "mpa", "M", "kPas", "corrected", "1/", "/", "%/-", "[",
                              "[]", "kPa]", "x/s", "a"})
    EXPECT_FALSE(find_unit(unknown)) << unknown;
  for (const std::string& name : unit_names()) EXPECT_TRUE(find_unit(name)) << name;
  EXPECT_FALSE(find_unit(std::string(100000, 'x')));
}

TEST(Units, in_a_header) {
  struct Case {
    const char *text, *name, *unit;
  };
  for (const Case& c :
       std::vector<Case>{{"Axial strain [%]", "Axial strain", "%"},
                         {"q (kPa)", "q", "kPa"},
                         {"q (corrected)", "q (corrected)", ""},
                         {"q [odd]", "q", "odd"},
                         {"q_kPa", "q", "kPa"},
                         {"eps_a", "eps_a", ""},
                         {"eps_a_pct", "eps_a", "pct"},
                         {"shear_rate_per_s", "shear_rate", "per_s"},
                         {"rate_measured_pct_per_min", "rate_measured", "pct_per_min"},
                         {"density_kg_per_m3", "density", "kg_per_m3"},
                         {"p_eff_kPa", "p_eff", "kPa"},
                         {"time_s", "time", "s"},
                         {"q / kPa", "q", "kPa"},
                         {"t / s", "t", "s"},
                         {"q/kPa", "q", "kPa"},
                         {"eta = q/p", "eta = q/p", ""},
                         {"q/p", "q/p", ""},
                         {"q in kPa", "q", "kPa"},
                         {"strain %", "strain", "%"},
                         {"Void ratio", "Void ratio", ""},
                         {"a\r\n b", "a b", ""},
                         {"[kPa]", "[kPa]", ""},
                         {"", "", ""}}) {
    const ColumnHeader header = read_header(c.text);
    EXPECT_EQ(header.name, c.name) << c.text;
    EXPECT_EQ(header.unit, c.unit) << c.text;
  }
}

TEST(Units, shapes_of_cells) {
  const auto kind = [](std::string_view text) { return shape_of(text).kind; };
  for (const char* number : {"1", "+1", "-1", "\u22121", "1.", ".5", ",5", "1,5", "1D-3", "1e5",
                             "1E+05", "\u00A01.5\u00A0"})
    EXPECT_EQ(kind(number), CellKind::number) << number;
  for (const char* text : {"1,", "1.2.3", "12.03.2016", "e5", "1e", "1e5x", "+", "+-1", "1..2",
                           "0x1", "1;2", "1,2,3", "1234,567.8", "\u2212"})
    EXPECT_EQ(kind(text), CellKind::text) << text;
  for (const char* grouped : {"1,234.5", "1.234,5", "1,234,567", "1.234.567", "1 234", "1 234,5",
                              "1'234.5", "1,234.5e3", "1_000"})
    EXPECT_EQ(kind(grouped), CellKind::grouped) << grouped;
  for (const char* missing : {"nan", "NaN", "NA", "n/a", "#N/A", "-", "--", "\u2013", "null"})
    EXPECT_EQ(kind(missing), CellKind::missing) << missing;
  EXPECT_EQ(kind(" \t"), CellKind::blank);
  EXPECT_EQ(kind("-inf"), CellKind::not_finite);
  EXPECT_TRUE(shape_of("1,234").may_be_grouped);
  for (const char* sure : {"0,234", "1234,567", "1,23", "1,2345", "1,234e2", ",234"})
    EXPECT_FALSE(shape_of(sure).may_be_grouped) << sure;
  EXPECT_EQ(value_of("1D-3", '.'), 1e-3);
  EXPECT_EQ(value_of("\u22121,5", ','), -1.5);
  EXPECT_EQ(value_of("1e400", '.'), std::nullopt);
  EXPECT_EQ(value_of("0e999", '.'), 0.0);
  EXPECT_EQ(value_of("0.001e400", '.'), std::nullopt);
  EXPECT_EQ(value_of("1e-400", '.'), 0.0);
  EXPECT_EQ(value_of("1e99999999999999999999", '.'), std::nullopt);
}

}  // namespace
}  // namespace repose::io
