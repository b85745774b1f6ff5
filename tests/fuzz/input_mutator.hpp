#pragma once
/// \file
/// Changes of an input file that keep it a TOML file, driven by the key tables of input/: a known
/// key gets a value of its own kind, of another one, or beyond all sizes; tables are left out,
/// doubled, put elsewhere.

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "input/key_info.hpp"

namespace repose::fuzz {

using Random = std::mt19937_64;

class InputMutator {
 public:
  InputMutator();

  /// Every kind of file that `repose check` reads.
  std::size_t kinds() const { return kinds_.size(); }
  const std::string& kind_name(std::size_t kind) const { return kinds_[kind].name; }
  /// A file of a kind made of known keys alone, most of them in range.
  std::string made_up(std::size_t kind, Random& random) const;
  /// The text with some changes. A text that is no TOML comes back as it is.
  std::string changed(const std::string& text, Random& random) const;

 private:
  struct Kind {
    std::string name;
    std::vector<input::KeyInfo> keys;
  };
  std::vector<Kind> kinds_;
};

}  // namespace repose::fuzz
