#include "io/stl.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "io/number_text.hpp"
#include "io/table_error.hpp"

namespace repose::io {
namespace {

using Vertex = std::array<double, 3>;

/// Numbers the vertices as they come.
class Builder {
 public:
  std::uint32_t vertex(const Vertex& x) {
    const auto [at, is_new] =
        known_.try_emplace(x, static_cast<std::uint32_t>(result_.vertices.size()));
    if (is_new) result_.vertices.push_back(x);
    return at->second;
  }
  void triangle(const std::array<Vertex, 3>& corners) {
    const std::array<std::uint32_t, 3> n{vertex(corners[0]), vertex(corners[1]),
                                         vertex(corners[2])};
    if (n[0] != n[1] && n[1] != n[2] && n[2] != n[0]) result_.corners.push_back(n);
  }
  Triangles take(const std::string& name) {
    if (result_.corners.empty()) throw TableError(name, 0, "", "there are no triangles in it", "");
    return std::move(result_);
  }

 private:
  Triangles result_;
  std::map<Vertex, std::uint32_t> known_;
};

constexpr std::size_t header_bytes = 80, count_bytes = 4, triangle_bytes = 50;

template <class T>
T little_endian(std::string_view bytes, std::size_t at) {
  static_assert(std::endian::native == std::endian::little);
  T x;
  std::memcpy(&x, bytes.data() + at, sizeof x);
  return x;
}

Triangles parse_binary(std::string_view bytes, const std::string& name) {
  constexpr std::size_t begin = header_bytes + count_bytes;
  const std::size_t count = little_endian<std::uint32_t>(bytes, header_bytes);
  const std::size_t held = (bytes.size() - begin) / triangle_bytes;
  if (bytes.size() != begin + count * triangle_bytes)
    throw TableError(
        name, 0, "",
        fmt::format("its head tells of {} triangles, and there is room for {}{}", count, held,
                    bytes.size() == begin + held * triangle_bytes ? "" : " and a part of one"),
        held < count ? "the file is cut off" : "");
  Builder builder;
  for (std::size_t n = 0; n < count; ++n) {
    std::array<Vertex, 3> corners;
    for (std::size_t k = 0; k < 9; ++k) {
      const std::size_t at = begin + n * triangle_bytes + 12 + 4 * k;
      const double x = little_endian<float>(bytes, at);
      if (!std::isfinite(x))
        throw TableError(name, 0, "",
                         fmt::format("corner {} of triangle {} is not finite", k / 3 + 1, n + 1),
                         "");
      corners[k / 3][k % 3] = x + 0.0;  // −0 and 0 are one place
    }
    builder.triangle(corners);
  }
  return builder.take(name);
}

/// solid NAME, then facet normal N outer loop vertex X vertex X vertex X endloop endfacet …, then
/// endsolid NAME; in any case, and several solids one after the other.
class AsciiStl {
 public:
  AsciiStl(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  Triangles parse() {
    expect("solid");
    skip_line();
    for (;;) {
      std::string_view word = next();
      if (same(word, "facet")) {
        facet();
      } else if (same(word, "endsolid")) {
        skip_line();
        word = next();
        if (word.empty()) return builder_.take(name_);
        if (!same(word, "solid")) fail(fmt::format("{} stands where a solid begins", shown(word)));
        skip_line();
      } else if (word.empty()) {
        fail("the file ends before endsolid", "it is cut off");
      } else {
        fail(fmt::format("{} stands where facet or endsolid is expected", shown(word)));
      }
    }
  }

 private:
  static bool same(std::string_view word, std::string_view wanted) {
    if (word.size() != wanted.size()) return false;
    for (std::size_t k = 0; k < word.size(); ++k) {
      const char c = word[k];
      if ((c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c) != wanted[k]) return false;
    }
    return true;
  }
  [[noreturn]] void fail(const std::string& cause, const std::string& cure = "") const {
    throw TableError(name_, row_, "", cause, cure);
  }
  std::string_view next() {
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
    while (place_ < text_.size() && blank(text_[place_])) {
      if (text_[place_] == '\n') ++row_;
      ++place_;
    }
    const std::size_t begin = place_;
    while (place_ < text_.size() && !blank(text_[place_])) ++place_;
    return text_.substr(begin, place_ - begin);
  }
  void skip_line() {
    while (place_ < text_.size() && text_[place_] != '\n') ++place_;
  }
  void expect(std::string_view wanted) {
    const std::string_view word = next();
    if (word.empty())
      fail(fmt::format("the file ends where {} is expected", wanted), "it is cut off");
    if (!same(word, wanted))
      fail(fmt::format("{} stands where {} is expected", shown(word), wanted));
  }
  double number() {
    std::string_view word = next();
    if (word.empty()) fail("the file ends within a triangle", "it is cut off");
    const std::string_view whole = word;
    if (word.starts_with('+')) word.remove_prefix(1);
    double x = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
    if (error != std::errc() || end != word.data() + word.size())
      fail(fmt::format("{} is no number", shown(whole)));
    return x;
  }
  void facet() {
    expect("normal");
    // often "nan nan nan" of a triangle without area: it is passed over in any case
    for (int k = 0; k < 3; ++k) number();
    expect("outer");
    expect("loop");
    std::array<Vertex, 3> corners;
    for (Vertex& corner : corners) {
      expect("vertex");
      for (double& x : corner) {
        x = number() + 0.0;
        if (!std::isfinite(x)) fail("a corner is not finite");
      }
    }
    expect("endloop");
    expect("endfacet");
    builder_.triangle(corners);
  }

  std::string_view text_;
  std::string name_;
  std::size_t place_ = 0;
  int row_ = 1;
  Builder builder_;
};

}  // namespace

Triangles parse_stl(std::string_view bytes, const std::string& name) {
  // a binary file may begin with "solid" too: its length tells
  const bool is_long = bytes.size() >= header_bytes + count_bytes;
  const bool fits =
      is_long && bytes.size() == header_bytes + count_bytes +
                                     triangle_bytes * std::size_t{little_endian<std::uint32_t>(
                                                          bytes, header_bytes)};
  const std::size_t begin = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  std::string first(bytes.substr(begin, 5));
  for (char& c : first)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  if (!fits && first == "solid" && bytes.find('\0') == std::string_view::npos)
    return AsciiStl(bytes, name).parse();
  if (!is_long)
    throw TableError(name, 0, "", "this is no STL file",
                     "an ASCII one begins with \"solid\", a binary one with a head of 84 bytes");
  return parse_binary(bytes, name);
}

}  // namespace repose::io
