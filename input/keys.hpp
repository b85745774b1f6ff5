#pragma once
/// \file
/// The keys of an input file, each written once: name, unit, range, meaning, default and the
/// variable that it lands in. A kind of input is a few functions such as grid_keys() of
/// read_scene.cpp, with a line for each key:
/// `keys.number({"h", "m", "cell size", positive, required}, scene.h)`. What `keys` is decides what
/// they do: read a file into the variables (read_keys.hpp), write the variables out as a file
/// (write_keys.hpp), or tell of the keys themselves (key_info.hpp), from which the JSON Schema and
/// the reference page are made (schema.hpp).

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "models/parameter.hpp"

namespace repose::input {

class TomlReader;
struct KeyInfo;

/// Must the file have the key? If not, what the variable holds beforehand is the default.
enum class Presence : std::uint8_t { defaulted, required };
inline constexpr Presence required = Presence::required;

struct Key {
  std::string_view name{};
  std::string_view unit{};  ///< "-" if it has none
  std::string_view doc{};
  Range range{};  ///< of numbers; infinities and NaN are refused in any case
  Presence presence = Presence::defaulted;
  bool applies = true;  ///< false: not written, and refused where it is given, because of `only`
  std::string_view only{};  ///< "only step.transfer = \"xpic\" and \"fmpm\" have an order"

  /// A key that some inputs have no use for.
  constexpr Key only_if(bool condition, std::string_view reason) const {
    Key key = *this;
    key.applies = condition;
    key.only = reason;
    return key;
  }
};

/// An integer's limits, both included.
struct Limits {
  std::int64_t lower = 0, upper = 0;
};

class Keys {
 public:
  virtual ~Keys() = default;

  virtual void number(const Key& key, double& x) = 0;
  virtual void number(const Key& key, std::optional<double>& x) = 0;
  virtual void integer(const Key& key, Limits limits, std::int64_t& x) = 0;
  virtual void integer(const Key& key, Limits limits, std::optional<std::int64_t>& x) = 0;
  virtual void boolean(const Key& key, bool& x) = 0;
  virtual void text(const Key& key, std::string& x) = 0;
  /// One of several words, as its position.
  virtual void word(const Key& key, std::span<const std::string_view> words, std::size_t& x) = 0;
  virtual void word(const Key& key, std::span<const std::string_view> words,
                    std::optional<std::size_t>& x) = 0;
  /// [x, y], or with three axes [x, y, z], each in the key's range; z is 0 where there is none.
  virtual void vector(const Key& key, std::size_t axes, std::array<double, 3>& x) = 0;
  /// Six components, or none.
  virtual void components(const Key& key, std::optional<std::array<double, 6>>& x) = 0;
  /// A list of at least one number; absent: what x holds.
  virtual void number_list(const Key& key, std::vector<double>& x) = 0;
  /// A list of at least one of several words, as positions; absent: what x holds.
  virtual void word_list(const Key& key, std::span<const std::string_view> words,
                         std::vector<std::size_t>& x) = 0;
  /// A list of texts; one alone may stand without brackets. Absent: what x holds.
  virtual void text_list(const Key& key, std::vector<std::string>& x) = 0;
  /// A table [name]; an absent one reads as empty.
  virtual void table(const Key& key, const std::function<void(Keys&)>& below) = 0;
  /// [[name]], at least one unless the key is defaulted: `resize` is told how many there are before
  /// `entry` sees each of them.
  virtual void tables(const Key& key, std::size_t count,
                      const std::function<void(std::size_t)>& resize,
                      const std::function<void(Keys&, std::size_t)>& entry) = 0;
  /// A value of several forms: `read` is called where the file has the key, `write` returns it as
  /// TOML, and `info` tells what may stand there.
  virtual void value(const Key& key, const std::function<void(TomlReader&)>& read,
                     const std::function<std::string()>& write, const KeyInfo& info) = 0;
  /// Keys that a table of something else defines (a law's parameters), in the same three ways. The
  /// lines that `write` returns stand in this table as they are.
  virtual void others(const std::function<void(TomlReader&)>& read,
                      const std::function<std::string()>& write,
                      const std::vector<KeyInfo>& info) = 0;

  /// Where the file is being read, for what depends on how a key was given; null otherwise.
  virtual TomlReader* reader() { return nullptr; }
  /// Every branch is to be visited, whatever the variables hold.
  virtual bool describes() const { return false; }

  void integer(const Key& key, Limits limits, int& x) {
    std::int64_t wide = x;
    integer(key, limits, wide);
    x = static_cast<int>(wide);
  }
  template <class Enum>
  void choice(const Key& key, std::span<const std::string_view> words, Enum& x) {
    auto position = static_cast<std::size_t>(x);
    word(key, words, position);
    x = static_cast<Enum>(position);
  }
  template <class Enum>
  void choice(const Key& key, std::span<const std::string_view> words, std::optional<Enum>& x) {
    std::optional<std::size_t> position;
    if (x) position = static_cast<std::size_t>(*x);
    word(key, words, position);
    if (position) x = static_cast<Enum>(*position);
  }
  template <class Enum>
  void choices(const Key& key, std::span<const std::string_view> words, std::vector<Enum>& x) {
    std::vector<std::size_t> positions;
    for (const Enum e : x) positions.push_back(static_cast<std::size_t>(e));
    word_list(key, words, positions);
    x.clear();
    for (const std::size_t k : positions) x.push_back(static_cast<Enum>(k));
  }
  /// [x, y] in the plane, [x, y, z] in space; either where the keys are described.
  void place(const Key& key, std::size_t axes, std::array<double, 3>& x) {
    vector(key, axes, x);
    if (describes()) vector(key, 3, x);
  }
  /// [x, y] where there are never three axes.
  void pair(const Key& key, std::array<double, 2>& x) {
    std::array<double, 3> wide{x[0], x[1], 0.0};
    vector(key, 2, wide);
    x = {wide[0], wide[1]};
  }
};

}  // namespace repose::input
