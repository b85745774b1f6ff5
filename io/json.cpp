#include "io/json.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

#include <nlohmann/json.hpp>

namespace repose::io {
namespace {

using Text = nlohmann::ordered_json;  ///< what reads and writes the text

Text to_text_tree(const Json& json) {
  if (json.is_object()) {
    Text object = Text::object();
    for (const auto& [key, value] : json.items()) object[key] = to_text_tree(value);
    return object;
  }
  if (json.is_array()) {
    Text list = Text::array();
    for (const Json& x : json) list.push_back(to_text_tree(x));
    return list;
  }
  if (json.is_string()) return json.get<std::string>();
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_unsigned()) return json.get<std::uint64_t>();
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_number()) return json.get<double>();
  return nullptr;
}

/// What refers to itself nowhere may still be nested deeper than a stack holds.
constexpr int most_levels = 500;

Json from_text_tree(const Text& text, int levels = 0) {
  if (levels > most_levels)
    throw Json::Error("nested more than " + std::to_string(most_levels) + " levels deep");
  switch (text.type()) {
    case Text::value_t::boolean:
      return text.get<bool>();
    case Text::value_t::number_integer:
      return text.get<std::int64_t>();
    case Text::value_t::number_unsigned:
      return text.get<std::uint64_t>();
    case Text::value_t::number_float:
      return text.get<double>();
    case Text::value_t::string:
      return text.get_ref<const std::string&>();
    case Text::value_t::array: {
      Json::Array list;
      list.reserve(text.size());
      for (const Text& x : text) list.push_back(from_text_tree(x, levels + 1));
      return list;
    }
    case Text::value_t::object: {
      Json object = Json::object();
      for (const auto& [key, value] : text.items()) object[key] = from_text_tree(value, levels + 1);
      return object;
    }
    default:
      return nullptr;
  }
}

std::string_view type_name(const Json& json) {
  if (json.is_object()) return "an object";
  if (json.is_array()) return "a list";
  if (json.is_string()) return "a text";
  if (json.is_boolean()) return "true or false";
  return json.is_number() ? "a number" : "null";
}

}  // namespace

Json::Json(Array list) : value_(std::move(list)) {}
Json::Json(const Json&) = default;
Json::Json(Json&&) noexcept = default;
Json& Json::operator=(const Json&) = default;
Json& Json::operator=(Json&&) noexcept = default;
Json::~Json() = default;

Json::Json(std::initializer_list<Json> list) {
  const bool pairs = std::all_of(list.begin(), list.end(), [](const Json& x) {
    return x.is_array() && x.size() == 2 && x[0].is_string();
  });
  if (!pairs) {
    value_ = Array(list);
    return;
  }
  *this = object();
  for (const Json& x : list) (*this)[x[0].to_text()] = x[1];
}

Json Json::object() {
  Json json;
  json.value_ = Object();
  return json;
}

namespace {

/// "line 2, column 7": of a byte, counted from 1.
std::string place_of(std::string_view text, std::size_t byte) {
  const std::string_view above = text.substr(0, byte == 0 ? 0 : std::min(byte - 1, text.size()));
  const auto lines = std::count(above.begin(), above.end(), '\n');
  const std::size_t start = above.rfind('\n');
  const std::size_t column = above.size() - (start == above.npos ? 0 : start + 1);
  return "line " + std::to_string(lines + 1) + ", column " + std::to_string(column + 1);
}

}  // namespace

Json Json::parse(std::string_view text) {
  try {
    return from_text_tree(Text::parse(text));
  } catch (const Text::parse_error& error) {
    throw Error(place_of(text, error.byte) + " is no JSON");
  } catch (const Text::exception&) {
    throw Error("a number is beyond what a double holds");
  }
}

std::optional<Json> Json::try_parse(std::string_view text) {
  const Text tree = Text::parse(text, nullptr, false);
  if (tree.is_discarded()) return {};
  try {
    return from_text_tree(tree);
  } catch (const Error&) {
    return {};
  }
}

std::string Json::dump(int indent) const {
  return to_text_tree(*this).dump(indent, ' ', false, Text::error_handler_t::replace);
}

bool Json::is_unsigned() const { return std::holds_alternative<std::uint64_t>(value_); }

bool Json::is_number_integer() const {
  return std::holds_alternative<std::int64_t>(value_) || is_unsigned();
}

bool Json::is_number() const {
  return std::holds_alternative<double>(value_) || is_number_integer();
}

std::size_t Json::size() const {
  if (is_null()) return 0;
  if (const Array* list = std::get_if<Array>(&value_)) return list->size();
  if (const Object* object = std::get_if<Object>(&value_)) return object->size();
  return 1;
}

void Json::refuse(std::string_view wanted) const {
  throw Error("this is " + std::string(type_name(*this)) + ", not " + std::string(wanted));
}

Json& Json::operator[](std::string_view key) & {
  if (is_null()) value_ = Object();
  if (!is_object()) refuse("an object");
  if (const Json* known = find(key)) return const_cast<Json&>(*known);
  Object& members = std::get<Object>(value_);
  members.push_back({std::string(key), Json()});
  return members.back().value;
}

const Json* Json::find(std::string_view key) const {
  const Object* members = std::get_if<Object>(&value_);
  if (!members) return nullptr;
  for (const Member& member : *members)
    if (member.key == key) return &member.value;
  return nullptr;
}

const Json& Json::at(std::string_view key) const& {
  if (!is_object()) refuse("an object with \"" + std::string(key) + "\"");
  if (const Json* member = find(key)) return *member;
  throw Error("\"" + std::string(key) + "\" is missing");
}

Json& Json::element(std::size_t i) {
  Array* list = std::get_if<Array>(&value_);
  if (!list) refuse("a list");
  if (i >= list->size())
    throw Error("element " + std::to_string(i) + " of a list of " + std::to_string(list->size()));
  return (*list)[i];
}

void Json::erase(std::string_view key) {
  if (is_null()) return;
  if (!is_object()) refuse("an object");
  std::erase_if(std::get<Object>(value_), [&](const Member& m) { return m.key == key; });
}

void Json::update(const Json& other) {
  for (const auto& [key, value] : other.items()) (*this)[key] = value;
}

void Json::push_back(Json x) {
  if (is_null()) value_ = Array();
  if (!is_array()) refuse("a list");
  std::get<Array>(value_).push_back(std::move(x));
}

const Json::Object& Json::items() const {
  static const Object none;
  if (is_null()) return none;
  if (!is_object()) refuse("an object");
  return std::get<Object>(value_);
}

const Json::Array& Json::elements() const {
  static const Array none;
  if (is_null()) return none;
  if (!is_array()) refuse("a list");
  return std::get<Array>(value_);
}

Json::Array::iterator Json::begin() {
  if (is_null()) value_ = Array();
  if (!is_array()) refuse("a list");
  return std::get<Array>(value_).begin();
}

Json::Array::iterator Json::end() { return begin() + static_cast<std::ptrdiff_t>(size()); }

std::string Json::value(std::string_view key, const char* fallback) const {
  return value<std::string>(key, fallback);
}

bool Json::to_bool() const {
  if (!is_boolean()) refuse("true or false");
  return std::get<bool>(value_);
}

std::int64_t Json::to_integer() const {
  if (const auto* x = std::get_if<std::int64_t>(&value_)) return *x;
  if (const auto* x = std::get_if<std::uint64_t>(&value_)) return static_cast<std::int64_t>(*x);
  // 2^63, beyond which a conversion has no value; false for not-a-number as well
  if (const auto* x = std::get_if<double>(&value_); x != nullptr && std::abs(*x) < 0x1p63)
    return static_cast<std::int64_t>(*x);
  refuse("an integer of 64 bits");
}

double Json::to_double() const {
  if (const auto* x = std::get_if<double>(&value_)) return *x;
  if (const auto* x = std::get_if<std::int64_t>(&value_)) return static_cast<double>(*x);
  if (const auto* x = std::get_if<std::uint64_t>(&value_)) return static_cast<double>(*x);
  refuse("a number");
}

const std::string& Json::to_text() const {
  if (!is_string()) refuse("a text");
  return std::get<std::string>(value_);
}

bool operator==(const Json& a, const Json& b) {
  if (a.is_number() && b.is_number()) {
    if (a.is_number_integer() && b.is_number_integer())
      return a.is_unsigned() || b.is_unsigned()
                 ? a.get<std::uint64_t>() == b.get<std::uint64_t>() &&
                       (a.is_unsigned() || a.get<std::int64_t>() >= 0) &&
                       (b.is_unsigned() || b.get<std::int64_t>() >= 0)
                 : a.get<std::int64_t>() == b.get<std::int64_t>();
    return a.get<double>() == b.get<double>();
  }
  if (a.is_object() && b.is_object())
    return std::equal(a.items().begin(), a.items().end(), b.items().begin(), b.items().end(),
                      [](const Json::Member& x, const Json::Member& y) {
                        return x.key == y.key && x.value == y.value;
                      });
  if (a.is_array() && b.is_array()) return a.elements() == b.elements();
  if (a.is_string() && b.is_string()) return a.to_text() == b.to_text();
  if (a.is_boolean() && b.is_boolean()) return a.to_bool() == b.to_bool();
  return a.is_null() && b.is_null();
}

std::ostream& operator<<(std::ostream& out, const Json& json) { return out << json.dump(); }

}  // namespace repose::io
