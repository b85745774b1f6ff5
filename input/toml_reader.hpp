#pragma once
/// \file
/// Typed reading of one table of an input file. A value of the wrong type or out of range, or a
/// missing one, is reported to the file and reading goes on with a stand-in; nothing read may be
/// used before InputFile::throw_if_bad() has passed.

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>

#include "input/input_file.hpp"

namespace repose::input {

/// A number as a table may hold it.
struct NumberKey {
  std::string_view key;
  std::string_view unit;  ///< "-" if it has none
  std::string_view doc;
  Range range{};                   ///< infinities and NaN are refused in any case
  std::optional<double> fallback;  ///< absent: the key is required
};

class TomlReader {
 public:
  /// The whole file.
  explicit TomlReader(InputFile& file) : TomlReader(file, &file.root(), "") {}

  InputFile& file() const { return *file_; }
  const std::string& path() const { return path_; }
  std::string path_of(std::string_view key) const { return join_path(path_, key); }
  bool has(std::string_view key) const;
  /// The raw value, or null.
  const toml::node* get(std::string_view key) const;

  /// Integers count as numbers.
  double number(const NumberKey& key);
  std::optional<double> optional_number(const NumberKey& key);
  std::int64_t integer(std::string_view key, std::string_view doc, std::int64_t lower,
                       std::int64_t upper, std::optional<std::int64_t> fallback = {});
  bool boolean(std::string_view key, bool fallback);
  /// fallback absent: required.
  std::string text(std::string_view key, std::string_view doc,
                   std::optional<std::string> fallback = {});
  /// One of several words; returns its position.
  std::size_t choice(std::string_view key, const std::vector<std::string_view>& words,
                     std::size_t fallback);
  /// Absent where the key is, or what it says is none of the words, which is reported.
  std::optional<std::size_t> optional_choice(std::string_view key,
                                             const std::vector<std::string_view>& words);
  /// [x, y], each in the key's range.
  std::array<double, 2> pair(const NumberKey& key,
                             std::optional<std::array<double, 2>> fallback = {});
  /// [x, y], or with three axes [x, y, z], each in the key's range; z = 0 where there is none.
  std::array<double, 3> vector(const NumberKey& key, std::size_t axes,
                               std::optional<std::array<double, 3>> fallback = {});
  /// A list of at least one finite number.
  std::optional<std::vector<double>> number_list(const NumberKey& key);
  /// A list of at least one of several words, as their positions.
  std::optional<std::vector<std::size_t>> choices(std::string_view key,
                                                  const std::vector<std::string_view>& words);
  /// A list of exactly `count` finite numbers.
  std::optional<std::vector<double>> numbers(const NumberKey& key, std::size_t count);

  /// A table below this one; an absent one reads as empty, its required keys then count as missing.
  TomlReader table(std::string_view key);
  /// [[key]]: one reader per entry; none, with a report, if there is not at least one.
  std::vector<TomlReader> tables(std::string_view key, std::string_view doc);

  void report(std::string_view key, std::string_view message) {
    file_->report(path_of(key), message);
  }
  /// Declares a key that is read in another way.
  void expect(std::string_view key) { file_->expect(path_, key); }
  /// Any key may be here; the caller checks them.
  void expect_any() { file_->expect_any(path_); }
  /// But for those that are left out.
  std::vector<std::string> keys() const;
  /// Keys of this table that are read elsewhere, for readers that go through all keys.
  void leave_out(std::span<const std::string_view> keys) { left_out_ = keys; }

 private:
  TomlReader(InputFile& file, const toml::table* table, std::string path, bool broken = false)
      : file_(&file),
        table_(table),
        path_(std::move(path)),
        broken_(broken) {}
  std::optional<std::size_t> position(const toml::node& node, std::string_view at,
                                      const std::vector<std::string_view>& words);
  std::vector<double> checked_list(const toml::array& list, const NumberKey& key);
  void wrong_type(std::string_view key, std::string_view expected);
  void missing(std::string_view key, std::string_view expected);
  /// The number at a path if it is one within range; reports it otherwise.
  std::optional<double> checked(const toml::node& node, std::string_view at, const NumberKey& key);

  InputFile* file_;
  const toml::table* table_;  ///< null: absent
  std::string path_;
  std::span<const std::string_view> left_out_{};
  bool broken_;  ///< not a table at all, which has been reported: nothing is missing from it
};

/// "the string \"1e3\"", "the integer 3", "a list of 3": what a message says was found.
std::string describe(const toml::node& node);

}  // namespace repose::input
