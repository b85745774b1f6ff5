#pragma once
/// \file
/// What is known about the keys of one kind of input, for the JSON Schema, the reference page and
/// the test that walks every key.

#include <optional>
#include <string>
#include <vector>

#include "input/keys.hpp"

namespace repose::input {

enum class ValueKind : std::uint8_t {
  number,
  integer,
  boolean,
  text,
  word,         ///< one of KeyInfo::words
  number_list,  ///< of KeyInfo::least to KeyInfo::most numbers
  corner_list,  ///< [[x, y], …], of KeyInfo::least at least
  word_list,
  text_list,  ///< or one text
  table,
  tables,
  any_of,  ///< one of the forms in KeyInfo::below
};

struct KeyInfo {
  std::string name;
  ValueKind kind = ValueKind::number;
  std::string unit = "-";
  std::string doc;
  Range range{};
  std::optional<Limits> limits;  ///< of an integer
  bool required = false;
  std::string fallback;             ///< the default as TOML; "" where there is none
  std::string only;                 ///< what a key that not every input has belongs to
  std::vector<std::string> words;   ///< of a word and of a list of words
  std::size_t least = 1, most = 0;  ///< length of a list; most = 0: any
  std::vector<KeyInfo> below;       ///< keys of a table, or forms
  bool open = false;                ///< a table that may hold keys of the user's own naming
};

/// The keys that a function such as grid_keys() has.
std::vector<KeyInfo> describe_keys(const std::function<void(Keys&)>& keys);

}  // namespace repose::input
