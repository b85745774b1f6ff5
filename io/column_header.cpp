#include "io/column_header.hpp"

#include "io/number_text.hpp"
#include "io/units.hpp"

namespace repose::io {
namespace {

std::string in_one_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const char plain = c == '\r' || c == '\n' || c == '\t' ? ' ' : c;
    if (plain != ' ' || line.empty() || line.back() != ' ') line += plain;
  }
  return std::string(trimmed(line));
}

/// A unit that may follow a name after a blank alone: no word of a language is spelt so.
bool stands_alone(std::string_view text) {
  if (text == "%" || text == "\u2030" || text == "mm" || text == "cm" || text == "\u00B5m")
    return true;
  const auto unit = find_unit(text);
  return unit && unit->dimension == dimension::stress && text.size() > 1 && text != "at" &&
         text != "bar" && text != "atm";
}

bool name_and_unit(ColumnHeader& header, std::size_t name_end, std::string_view unit) {
  const std::string_view name = trimmed(std::string_view(header.text).substr(0, name_end));
  if (name.empty()) return false;
  header.name = name;
  header.unit = unit;
  return true;
}

bool in_brackets(ColumnHeader& header) {
  const std::string_view text = header.text;
  const bool square = text.ends_with(']');
  if (!square && !text.ends_with(')')) return false;
  const std::size_t open = text.rfind(square ? '[' : '(');
  if (open == std::string_view::npos) return false;
  const std::string_view inside = trimmed(text.substr(open + 1, text.size() - open - 2));
  if (inside.empty() || (!square && !find_unit(inside))) return false;
  return name_and_unit(header, open, inside);
}

/// "q / kPa", "q/kPa", "q, kPa"; one letter is a unit only after a blank: "t / s".
bool after_a_mark(ColumnHeader& header) {
  const std::string_view text = header.text;
  for (std::size_t at = text.find_first_of("/,"); at != std::string_view::npos;
       at = text.find_first_of("/,", at + 1)) {
    const std::string_view rest = text.substr(at + 1), unit = trimmed(rest);
    if (unit.empty() || !find_unit(unit) || find_unit(unit)->dimension == dimension::number) {
      if (unit != "%" && unit != "\u2030" && unit != "-") continue;
    }
    if (unit.size() == 1 && unit != "%" && !rest.starts_with(' ')) continue;
    return name_and_unit(header, at, unit);
  }
  return false;
}

bool after_a_blank(ColumnHeader& header) {
  const std::string_view text = header.text;
  const std::size_t blank = text.rfind(' ');
  if (blank == std::string_view::npos) return false;
  const std::string_view unit = text.substr(blank + 1), before = trimmed(text.substr(0, blank));
  if (before.size() > 3 && before.ends_with(" in") && find_unit(unit))
    return name_and_unit(header, before.size() - 3, unit);
  return stands_alone(unit) && name_and_unit(header, blank, unit);
}

/// "q_kPa", "rate_pct_per_min": the longest end after a low line that is a unit.
bool at_the_end_of_a_word(ColumnHeader& header) {
  const std::string_view text = header.text;
  if (text.find(' ') != std::string_view::npos) return false;
  for (std::size_t at = text.find('_'); at != std::string_view::npos; at = text.find('_', at + 1)) {
    const std::string_view unit = text.substr(at + 1);
    if (unit.empty() || unit == "1" || unit == "-" || unit == "none" || !find_unit(unit)) continue;
    header.unit_in_name = true;
    return name_and_unit(header, at, unit);
  }
  return false;
}

}  // namespace

ColumnHeader read_header(std::string_view text) {
  ColumnHeader header;
  header.text = in_one_line(text);
  if (in_brackets(header) || after_a_mark(header) || after_a_blank(header) ||
      at_the_end_of_a_word(header))
    return header;
  header.name = header.text;
  header.unit.clear();
  header.unit_in_name = false;
  return header;
}

}  // namespace repose::io
