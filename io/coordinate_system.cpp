#include "io/coordinate_system.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <vector>

#include <fmt/format.h>

namespace repose::io {
namespace {

/// KEYWORD["value", value, BELOW[...], ...]
struct Element {
  std::string keyword;  ///< in capitals
  std::vector<std::string> values;
  std::vector<Element> below;

  const Element* find(std::initializer_list<std::string_view> keywords) const {
    const auto found = std::find_if(below.begin(), below.end(),
                                    [&](const Element& element) { return element.is(keywords); });
    return found == below.end() ? nullptr : &*found;
  }
  bool is(std::initializer_list<std::string_view> keywords) const {
    return std::find(keywords.begin(), keywords.end(), keyword) != keywords.end();
  }
};

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  /// Nothing where the text is no WKT.
  std::optional<Element> element(int depth = 0) {
    constexpr int deepest = 20;  // real ones have about eight
    Element found;
    found.keyword = word();
    if (found.keyword.empty() || depth > deepest || !take("[(")) return {};
    do {
      if (next() == '"') {
        found.values.push_back(quoted());
      } else if (std::isalpha(static_cast<unsigned char>(next())) != 0) {
        const std::size_t before = place_;
        std::string name = word();  // of an element, or a word such as NORTH
        if (next() == '[' || next() == '(') {
          place_ = before;
          std::optional<Element> child = element(depth + 1);
          if (!child) return {};
          found.below.push_back(std::move(*child));
        } else {
          found.values.push_back(std::move(name));
        }
      } else {
        found.values.push_back(number());
      }
    } while (take(","));
    if (!take("])")) return {};
    return found;
  }

 private:
  /// The next character that is no blank; 0 at the end.
  char next() {
    while (place_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[place_])) != 0)
      ++place_;
    return place_ < text_.size() ? text_[place_] : '\0';
  }
  bool take(std::string_view any) {
    if (next() == '\0' || any.find(next()) == std::string_view::npos) return false;
    ++place_;
    return true;
  }
  std::string word() {
    next();
    std::string found;
    while (place_ < text_.size() &&
           (std::isalnum(static_cast<unsigned char>(text_[place_])) != 0 || text_[place_] == '_'))
      found += static_cast<char>(std::toupper(static_cast<unsigned char>(text_[place_++])));
    return found;
  }
  std::string quoted() {
    std::string found;
    for (++place_; place_ < text_.size(); ++place_) {
      if (text_[place_] == '"') {
        if (place_ + 1 >= text_.size() || text_[place_ + 1] != '"') break;
        ++place_;  // two stand for one
      }
      found += text_[place_];
    }
    ++place_;
    return found;
  }
  std::string number() {
    std::string found;
    while (place_ < text_.size() && text_[place_] != ',' && text_[place_] != ']' &&
           text_[place_] != ')')
      found += text_[place_++];
    return found;
  }

  std::string_view text_;
  std::size_t place_ = 0;
};

/// The system of the plane, and that of heights where there is one.
struct Parts {
  std::optional<Element> plane, heights;
};
Parts parts_of(std::string_view wkt) {
  std::optional<Element> whole = Reader(wkt).element();
  if (whole && whole->is({"BOUNDCRS"}))  // with a way to another system
    if (const Element* const source = whole->find({"SOURCECRS"}); source && !source->below.empty())
      whole = Element(source->below.front());
  if (!whole || !whole->is({"COMPD_CS", "COMPOUNDCRS"})) return {std::move(whole), {}};
  Parts parts;
  for (Element& part : whole->below)
    if (part.is({"VERT_CS", "VERTCRS", "VERTICALCRS"}))
      parts.heights = std::move(part);
    else if (!parts.plane && !part.is({"AUTHORITY", "ID"}))
      parts.plane = std::move(part);
  return parts;
}

/// "foot, 0.3048 m" of a system that does not count in metres; else empty.
std::string other_unit(const Element& system) {
  const Element* unit = system.find({"UNIT", "LENGTHUNIT"});
  if (unit == nullptr)
    if (const Element* const axis = system.find({"AXIS"})) unit = axis->find({"LENGTHUNIT"});
  if (unit == nullptr || unit->values.size() < 2) return "";
  const std::string& text = unit->values[1];
  double metres = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), metres);
  if (error != std::errc() || std::abs(metres - 1.0) < 1e-9) return "";
  return fmt::format("{}, {} m", unit->values[0], metres);
}

}  // namespace

std::string why_not_metres(std::string_view wkt) {
  const auto [plane, heights] = parts_of(wkt);
  if (plane) {
    const std::string name = plane->values.empty() ? "" : fmt::format(" ({})", plane->values[0]);
    if (plane->is({"GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS", "GEOCCS"}))
      return plane->is({"GEOCCS"}) ? "its places are geocentric" + name
                                   : "its places are in degrees" + name;
    if (const std::string unit = other_unit(*plane); !unit.empty())
      return "its places are in " + unit;
  }
  if (heights)
    if (const std::string unit = other_unit(*heights); !unit.empty())
      return "its heights are in " + unit;
  return "";
}

std::string epsg_of(std::string_view wkt) {
  const std::optional<Element> plane = parts_of(wkt).plane;
  if (!plane) return "";
  // the last is the system's own, should the text say another before it
  for (auto it = plane->below.rbegin(); it != plane->below.rend(); ++it)
    if (it->is({"AUTHORITY", "ID"}) && it->values.size() >= 2 && it->values[0] == "EPSG")
      return it->values[1];
  return "";
}

}  // namespace repose::io
