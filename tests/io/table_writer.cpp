#include "tests/io/table_writer.hpp"

#include <algorithm>

#include <fmt/core.h>

namespace repose::io {
namespace {

/// Characters of the tests' texts; all lie in the basic plane.
std::vector<char16_t> code_units(std::string_view utf8) {
  std::vector<char16_t> units;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto byte = [&](std::size_t k) {
      return static_cast<unsigned>(static_cast<unsigned char>(utf8[k]));
    };
    const unsigned a = byte(i);
    if (a < 0x80) {
      units.push_back(static_cast<char16_t>(a));
      i += 1;
    } else if (a < 0xE0) {
      units.push_back(static_cast<char16_t>((a & 0x1F) << 6 | (byte(i + 1) & 0x3F)));
      i += 2;
    } else {
      units.push_back(static_cast<char16_t>((a & 0xF) << 12 | (byte(i + 1) & 0x3F) << 6 |
                                            (byte(i + 2) & 0x3F)));
      i += 3;
    }
  }
  return units;
}

std::string quoted(const std::string& cell) {
  std::string text = "\"";
  for (const char c : cell) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

}  // namespace

std::string encoded(const std::string& utf8, WrittenEncoding encoding) {
  if (encoding == WrittenEncoding::utf8) return utf8;
  if (encoding == WrittenEncoding::utf8_mark) return "\xEF\xBB\xBF" + utf8;
  std::string bytes;
  if (encoding == WrittenEncoding::windows_1252) {
    for (const char16_t u : code_units(utf8)) {
      const bool dash = u == 0x2212 || u == 0x2013;  // it has no minus of its own
      bytes += static_cast<char>(dash ? 0x96 : u);
    }
    return bytes;
  }
  const bool big =
      encoding == WrittenEncoding::utf16_be || encoding == WrittenEncoding::utf16_be_bare;
  std::vector<char16_t> units = code_units(utf8);
  if (encoding == WrittenEncoding::utf16_le || encoding == WrittenEncoding::utf16_be)
    units.insert(units.begin(), 0xFEFF);
  for (const char16_t u : units) {
    const char high = static_cast<char>(u >> 8), low = static_cast<char>(u & 0xFF);
    bytes += big ? high : low;
    bytes += big ? low : high;
  }
  return bytes;
}

std::string respelled(const std::string& number, Spelling spelling, char decimal) {
  std::string text = number;
  const bool negative = text.starts_with('-');
  const bool point = text.find('.') != std::string::npos;
  switch (spelling) {
    case Spelling::plain:
      break;
    case Spelling::plus:
      if (!negative) text = "+" + text;
      break;
    case Spelling::exponent:
      text += "e+00";
      break;
    case Spelling::fortran:
      text += "D0";
      break;
    case Spelling::unicode_minus:
      if (negative) text = "\u2212" + text.substr(1);
      break;
    case Spelling::short_form:  // .5 and 1. ; a trailing comma is no number
      if (text.starts_with("0.")) text = text.substr(1);
      if (text.starts_with("-0.")) text = "-" + text.substr(2);
      if (!point && decimal == '.') text += ".";
      break;
  }
  std::replace(text.begin(), text.end(), '.', decimal);
  return text;
}

WrittenTable written(const Truth& truth, const Dialect& d) {
  WrittenTable out;
  std::string text;
  int row = 0;
  const std::string end(d.line_end);
  const auto line = [&](const std::string& s) {
    text += s + end;
    return ++row;
  };
  const auto join = [&](const std::vector<std::string>& cells, bool quotes) {
    std::string s;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string pad = d.padded ? " " : "";
      const bool quote = quotes || cells[i].find('"') != std::string::npos;
      s += (i > 0 ? std::string(1, d.separator) : "") + pad +
           (quote ? quoted(cells[i]) : cells[i]) + pad;
    }
    return s;
  };
  const auto comment = [&] {
    if (d.comments > 0)
      line(std::string(d.comments == 1   ? "#"
                       : d.comments == 2 ? "%"
                                         : "//") +
           " made 12.03.2016, p0 = 100,5; \"x");
  };
  comment();
  if (d.title) {
    line("Laboratory of soils");
    line("Sample" + std::string(1, d.separator) + "12");
  }
  if (d.empty_lines) line("");

  std::vector<std::string> names, units;
  if (d.text_column) {
    names.push_back("Lab\"ID\"");
    units.push_back("-");
  }
  out.first = names.size();
  // blanks cannot stand in a name where they separate
  const bool blanks = d.separator == ' ' && d.quotes == 0;
  const std::string gap = blanks ? "" : " ";
  switch (d.units) {
    case WrittenUnits::brackets:
      names.insert(names.end(),
                   {"strain" + gap + "[%]", "q" + gap + "[kN/m\u00B2]", "t" + gap + "[min]"});
      break;
    case WrittenUnits::parentheses:
      names.insert(names.end(), {"strain" + gap + "(%)", "q" + gap + "(kPa)", "t" + gap + "(min)"});
      break;
    case WrittenUnits::in_word:
      names.insert(names.end(), {"strain_pct", "q_kPa", "t_min"});
      break;
    default:
      names.insert(names.end(), {"strain", "q", "t"});
  }
  out.header_row = line(join(names, d.quotes > 0));
  if (d.units == WrittenUnits::row) units.insert(units.end(), {"%", "kPa", "min"});
  if (d.units == WrittenUnits::bracket_row) units.insert(units.end(), {"[%]", "[kPa]", "[min]"});
  if (units.size() == names.size()) out.unit_row = line(join(units, d.quotes > 1));
  if (d.empty_lines) line("");
  static constexpr const char* missing[] = {"", "", "nan", "NA", "-", "\u2013"};
  for (std::size_t i = 0; i < truth.strain.size(); ++i) {
    if (i == 2) comment();
    std::vector<std::string> cells;
    if (d.text_column) cells.push_back(i < 4 ? "A\"7\"" : "D3");
    cells.push_back(respelled(truth.strain[i], d.spelling, d.decimal));
    cells.push_back(respelled(truth.stress[i], d.spelling, d.decimal));
    const bool left_out =
        d.gaps > 0 && std::find(truth.gaps.begin(), truth.gaps.end(), i) != truth.gaps.end();
    cells.push_back(left_out ? missing[d.gaps] : respelled(truth.time[i], d.spelling, d.decimal));
    out.rows.push_back(line(join(cells, d.quotes > 1)));
    if (d.empty_lines && i == 3) line(d.separator == ' ' ? "  " : std::string(2, d.separator));
  }
  if (!d.last_line_end) text.resize(text.size() - end.size());
  out.bytes = encoded(text, d.encoding);
  return out;
}

std::string to_string(const Dialect& d) {
  return fmt::format(
      "separator '{}' decimal '{}' encoding {} line end {} quotes {} units {} spelling {} comments "
      "{} title {} text "
      "{} gaps {} empty lines {} padded {} last {}",
      d.separator, d.decimal, static_cast<int>(d.encoding),
      d.line_end.size() == 2 ? "CRLF"
      : d.line_end == "\n"   ? "LF"
                             : "CR",
      d.quotes, static_cast<int>(d.units), static_cast<int>(d.spelling), d.comments, d.title,
      d.text_column, d.gaps, d.empty_lines, d.padded, d.last_line_end);
}

}  // namespace repose::io
