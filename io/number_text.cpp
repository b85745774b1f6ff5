#include "io/number_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>

namespace repose::io {
namespace {

constexpr std::array<std::string_view, 6> blanks{" ", "\t", "\u00A0", "\u2009", "\u202F", "\uFEFF"};
constexpr std::array<std::string_view, 4> minuses{"\u2212", "\u2013", "\uFE63", "\uFF0D"};
constexpr std::array<std::string_view, 7> group_marks{" ", "\u00A0", "\u2009", "\u202F",
                                                      "'", "\u2019", "_"};
constexpr std::array<std::string_view, 14> nothing{"nan", "-nan", "+nan",   "nan(ind)", "-nan(ind)",
                                                   "na",  "n/a",  "n.a.",   "#n/a",     "null",
                                                   "-",   "--",   "\u2013", "\u2014"};
constexpr std::array<std::string_view, 6> infinite{"inf",      "+inf",      "-inf",
                                                   "infinity", "+infinity", "-infinity"};

bool digit(char c) { return c >= '0' && c <= '9'; }

template <std::size_t n>
std::size_t starts_with_one(std::string_view text, const std::array<std::string_view, n>& of) {
  for (const std::string_view word : of)
    if (text.starts_with(word)) return word.size();
  return 0;
}

template <std::size_t n>
bool is_one(std::string_view text, const std::array<std::string_view, n>& of) {
  if (text.size() > 12) return false;
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return std::find(of.begin(), of.end(), lower) != of.end();
}

/// Takes a sign off the front; true if it is a minus.
bool take_sign(std::string_view& text) {
  if (text.starts_with('+') || text.starts_with('-')) {
    const bool minus = text.front() == '-';
    text.remove_prefix(1);
    return minus;
  }
  const std::size_t n = starts_with_one(text, minuses);
  text.remove_prefix(n);
  return n > 0;
}

std::string_view take_digits(std::string_view& text) {
  std::size_t n = 0;
  while (n < text.size() && digit(text[n])) ++n;
  const std::string_view digits = text.substr(0, n);
  text.remove_prefix(n);
  return digits;
}

/// An exponent takes all that is left, "e-3"; its digits with the sign, or none.
bool takes_exponent(std::string_view text) {
  if (text.empty() || std::string_view("eEdD").find(text.front()) == std::string_view::npos)
    return false;
  text.remove_prefix(1);
  take_sign(text);
  return !take_digits(text).empty() && text.empty();
}

/// "1,234.5", "1.234.567", "1 234": the rest of a number after its first group.
CellShape grouped_shape(std::string_view first, std::string_view rest) {
  const CellShape text{CellKind::text, 0, false};
  if (first.empty() || first.size() > 3) return text;
  std::string_view group;  // what stands between groups
  int groups = 0;
  while (!rest.empty()) {
    std::size_t n = starts_with_one(rest, group_marks);
    if (n == 0 && (rest.front() == '.' || rest.front() == ',')) n = 1;
    if (n == 0 || (!group.empty() && rest.substr(0, n) != group)) break;
    std::string_view after = rest.substr(n);
    if (take_digits(after).size() != 3) break;
    group = rest.substr(0, n);
    rest = after;
    ++groups;
  }
  if (groups == 0) return text;
  CellShape shape{CellKind::grouped, 0, false};
  if (!rest.empty() && (rest.front() == '.' || rest.front() == ',') && rest.substr(0, 1) != group) {
    shape.mark = rest.front();
    rest.remove_prefix(1);
    take_digits(rest);
  } else if (group == "." || group == ",") {
    shape.mark = group == "." ? ',' : '.';
  }
  return rest.empty() || takes_exponent(rest) ? shape : text;
}

/// Is the number's first digit that is not 0 worth 1 or more?
bool is_large(std::string_view whole, std::string_view fraction, std::string_view exponent) {
  long long power = 0;
  if (!exponent.empty()) {
    const bool negative = exponent.front() == '-';
    if (negative || exponent.front() == '+') exponent.remove_prefix(1);
    for (const char c : exponent) power = std::min(power * 10 + (c - '0'), 1'000'000'000LL);
    if (negative) power = -power;
  }
  const std::size_t first = whole.find_first_not_of('0');
  if (first != std::string_view::npos)
    return static_cast<long long>(whole.size() - first) + power > 0;
  const std::size_t after = fraction.find_first_not_of('0');
  return after != std::string_view::npos && power - static_cast<long long>(after) > 0;
}

}  // namespace

std::string shown(std::string_view cell) {
  constexpr std::size_t most = 40;
  return '"' + std::string(cell.substr(0, most)) + (cell.size() > most ? "...\"" : "\"");
}

std::string csv_cell(std::string text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2)
    text.insert(at, 1, '"');
  return '"' + text + '"';
}

double two_digits(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", x);
  return std::strtod(text, nullptr);  // never throws, whatever the exponent
}

std::string grouped(double x) {
  char text[400];  // any double
  std::snprintf(text, sizeof text, "%.0f", x);
  std::string digits = text;
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, " ");
  return digits;
}

std::string_view trimmed(std::string_view text) {
  while (const std::size_t n = starts_with_one(text, blanks)) text.remove_prefix(n);
  const auto blank_at_end = [&] {
    for (const std::string_view blank : blanks)
      if (text.ends_with(blank)) return blank.size();
    return std::size_t{0};
  };
  while (const std::size_t n = blank_at_end()) text.remove_suffix(n);
  return text;
}

CellShape shape_of(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.empty()) return {};
  std::string_view rest = cell;
  take_sign(rest);
  if (rest.empty() || !(digit(rest.front()) || rest.front() == '.' || rest.front() == ',')) {
    if (is_one(cell, nothing)) return {CellKind::missing, 0, false};
    if (is_one(cell, infinite)) return {CellKind::not_finite, 0, false};
    return {CellKind::text, 0, false};
  }
  const std::string_view whole = take_digits(rest);
  if (rest.empty() || takes_exponent(rest)) return {CellKind::number, 0, false};
  const std::string_view from_mark = rest;
  if (const char mark = rest.front(); mark == '.' || mark == ',') {
    rest.remove_prefix(1);
    const std::string_view fraction = take_digits(rest);
    const bool digits = !fraction.empty() || (!whole.empty() && mark == '.');
    if (digits && (rest.empty() || takes_exponent(rest)))
      return {CellKind::number, mark,
              rest.empty() && !whole.empty() && whole.size() <= 3 && whole.front() != '0' &&
                  fraction.size() == 3};
  }
  return grouped_shape(whole, from_mark);
}

std::optional<double> value_of(std::string_view cell, char mark) {
  std::string_view rest = trimmed(cell);
  std::string plain;
  plain.reserve(rest.size() + 2);
  if (take_sign(rest)) plain += '-';
  const std::string_view whole = take_digits(rest);
  std::string_view fraction;
  if (rest.starts_with(mark)) {
    rest.remove_prefix(1);
    fraction = take_digits(rest);
  }
  plain.append(whole.empty() ? "0" : whole).append(".").append(fraction.empty() ? "0" : fraction);
  std::string exponent;
  if (!rest.empty()) {
    rest.remove_prefix(1);
    if (take_sign(rest)) exponent = "-";
    exponent.append(rest);
    plain.append("e").append(exponent);
  }
  double x = 0.0;
  const auto [end, error] = std::from_chars(plain.data(), plain.data() + plain.size(), x);
  if (error == std::errc::result_out_of_range) {
    if (is_large(whole, fraction, exponent)) return {};
    return plain.starts_with('-') ? -0.0 : 0.0;
  }
  return x;
}

}  // namespace repose::io
