#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace repose::io {

/// A member of an object: a template, so that it may hold a value that holds members.
template <class Value>
struct JsonMember {
  std::string key;
  Value value;
};

/// A JSON value (RFC 8259). Members of an object keep the order in which they were added. Written
/// as
///     Json{{"rows", 240}, {"columns", {"t", "q"}}, {"note", nullptr}}
/// where a list of pairs that start with a text is an object, any other list an array.
/// Numbers that are not finite are written as null. Text and numbers are read and written by
/// nlohmann::json, whose headers cost more to compile than most files that need a summary.
class Json {
 public:
  using Member = JsonMember<Json>;
  using Array = std::vector<Json>;
  using Object = std::vector<Member>;

  /// Text that is no JSON, a member that is missing, a value of another type.
  class Error : public std::runtime_error {
   public:
    using std::runtime_error::runtime_error;
  };

  Json() = default;
  Json(std::nullptr_t) {}
  Json(std::same_as<bool> auto x) : value_(x) {}
  template <std::signed_integral T>
  Json(T x) : value_(static_cast<std::int64_t>(x)) {}
  template <std::unsigned_integral T>
  requires(!std::same_as<T, bool>) Json(T x) : value_(static_cast<std::uint64_t>(x)) {}
  template <std::floating_point T>
  Json(T x) : value_(static_cast<double>(x)) {}
  Json(const char* text) : value_(std::string(text)) {}
  Json(std::string_view text) : value_(std::string(text)) {}
  Json(std::string text) : value_(std::move(text)) {}
  template <class T>
  Json(const std::vector<T>& list) : value_(Array(list.begin(), list.end())) {}
  template <class T, std::size_t n>
  Json(const std::array<T, n>& list) : value_(Array(list.begin(), list.end())) {}
  Json(Array list);
  template <class T>
  Json(const std::map<std::string, T>& members);
  Json(std::initializer_list<Json> list);

  Json(const Json&);
  Json(Json&&) noexcept;
  Json& operator=(const Json&);
  Json& operator=(Json&&) noexcept;
  ~Json();

  static Json array() { return Array(); }
  static Json object();

  /// Errors: Error with the place and the reason.
  static Json parse(std::string_view text);
  /// Nothing if the text is no JSON.
  static std::optional<Json> try_parse(std::string_view text);
  /// In one line (indent < 0), or a member per line. Bytes that are no UTF-8 become U+FFFD.
  std::string dump(int indent = -1) const;

  bool is_null() const { return std::holds_alternative<std::monostate>(value_); }
  bool is_boolean() const { return std::holds_alternative<bool>(value_); }
  bool is_number_integer() const;
  bool is_unsigned() const;  ///< an integer that was given or read without a sign
  bool is_number() const;
  bool is_string() const { return std::holds_alternative<std::string>(value_); }
  bool is_array() const { return std::holds_alternative<Array>(value_); }
  bool is_object() const { return std::holds_alternative<Object>(value_); }

  /// bool, an integer, a floating-point number, std::string or a std::vector of those.
  /// Errors: Error for a value of another type; an integer may be taken from any number.
  template <class T>
  T get() const;
  /// The member as T, or the fallback where there is none.
  template <class T>
  T value(std::string_view key, const T& fallback) const;
  std::string value(std::string_view key, const char* fallback) const;

  /// Members of an object, elements of an array; 0 for null, 1 for anything else.
  std::size_t size() const;
  bool empty() const { return size() == 0; }

  /// Makes an object of null, and a member (null) where there is none. (Of a temporary, here and
  /// below, the value itself: a loop over read(file)["list"] holds what it goes through.)
  Json& operator[](std::string_view key) &;
  const Json& operator[](std::string_view key) const& { return at(key); }
  Json operator[](std::string_view key) && { return std::move((*this)[key]); }
  Json& operator[](std::integral auto i) & { return element(static_cast<std::size_t>(i)); }
  const Json& operator[](std::integral auto i) const& { return at(i); }
  Json operator[](std::integral auto i) && { return std::move((*this)[i]); }
  /// Errors: Error if there is none.
  const Json& at(std::string_view key) const&;
  const Json& at(std::integral auto i) const& {
    return const_cast<Json*>(this)->element(static_cast<std::size_t>(i));
  }
  Json at(std::string_view key) && { return const_cast<const Json&>(*this).at(key); }
  Json at(std::integral auto i) && { return std::move((*this)[i]); }
  /// Null if this is no object or has no such member.
  const Json* find(std::string_view key) const;
  bool contains(std::string_view key) const { return find(key) != nullptr; }
  void erase(std::string_view key);
  /// Takes the other object's members over, in their order.
  void update(const Json& other);
  /// Makes an array of null.
  void push_back(Json x);

  /// The members of an object; none of null. Errors: Error for anything else.
  const Object& items() const;
  /// The elements of an array; none of null. Errors: Error for anything else.
  const Array& elements() const;
  auto begin() const { return elements().begin(); }
  auto end() const { return elements().end(); }
  Array::iterator begin();
  Array::iterator end();
  const Json& front() const { return at(0); }
  const Json& back() const { return at(size() - 1); }
  Json& back() { return element(size() - 1); }

  /// Numbers are compared by value, objects in the order of their members.
  friend bool operator==(const Json& a, const Json& b);
  friend std::ostream& operator<<(std::ostream& out, const Json& json);

 private:
  [[noreturn]] void refuse(std::string_view wanted) const;
  Json& element(std::size_t i);
  bool to_bool() const;
  std::int64_t to_integer() const;
  double to_double() const;
  const std::string& to_text() const;

  std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, Array,
               Object>
      value_;
};

template <class T>
Json::Json(const std::map<std::string, T>& members) : Json(object()) {
  for (const auto& [key, value] : members) (*this)[key] = value;
}

template <class T>
T Json::get() const {
  if constexpr (std::same_as<T, bool>) {
    return to_bool();
  } else if constexpr (std::integral<T>) {
    return static_cast<T>(to_integer());
  } else if constexpr (std::floating_point<T>) {
    return static_cast<T>(to_double());
  } else if constexpr (std::same_as<T, std::string>) {
    return to_text();
  } else {
    T list;
    for (const Json& x : elements()) list.push_back(x.get<typename T::value_type>());
    return list;
  }
}

template <class T>
T Json::value(std::string_view key, const T& fallback) const {
  const Json* member = find(key);
  if constexpr (std::same_as<T, Json>)
    return member ? *member : fallback;
  else
    return member ? member->get<T>() : fallback;
}

}  // namespace repose::io
