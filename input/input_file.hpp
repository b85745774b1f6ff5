#pragma once
/// \file
/// A TOML input file with the overrides of the command line, the place where each key was written,
/// and the problems found in it.

#include <filesystem>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "models/parameter.hpp"

namespace repose::input {

/// Where a key was written: a line and column of the file, or with line 0 a --set text or the key
/// of a table that a program has made.
struct Origin {
  std::string source;
  unsigned line = 0;
  unsigned column = 0;
  bool is_override() const { return line == 0; }
};

/// "scene.toml:12:3" or "--set grid.h=0.1".
std::string to_string(const Origin& origin);

/// Input that cannot be used; the command prints every problem and exits with 2.
class BadInput : public std::runtime_error {
 public:
  /// problems: at least one, each complete with its place; what() is one per line.
  explicit BadInput(std::vector<std::string> problems);
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::vector<std::string> problems_;
};

/// The document and what is known about it. Key paths are written as in "body[0].law.K".
///
/// Readers (TomlReader) report problems here and go on, so that one attempt shows all of them;
/// throw_if_bad() ends it.
class InputFile {
 public:
  /// A law may stand in another file, law = "fitted.toml": its [law] table takes that place, a path
  /// being relative to the file that names it, or to where the command runs if --set does.
  ///
  /// Reads a file and applies the overrides ("grid.h=0.0125", in order). A value is TOML; a bare
  /// word counts as a string, so that quotes need not be protected from the shell.
  /// Errors: io::IoError if it cannot be read; BadInput for broken TOML or overrides.
  static InputFile read(const std::filesystem::path& file,
                        std::span<const std::string> overrides = {});

  /// The same from text in memory; `name` stands for the file in messages.
  static InputFile parse(std::string_view text, std::string name,
                         std::span<const std::string> overrides = {});

  /// The same from a table that a program has made: there is no line to point at, so a key's place
  /// is "NAME, key.path"; files that it names are relative to where the program runs.
  static InputFile from_table(std::string_view text, std::string name,
                              std::span<const std::string> overrides = {});

  /// This file, as it was parsed, with further overrides. Errors: BadInput.
  InputFile with(std::span<const std::string> overrides) const;

  const toml::table& root() const { return root_; }
  const std::string& name() const { return name_; }

  /// Where the key was written, or if it was not, the innermost table around it.
  Origin origin(std::string_view key_path) const;

  void report(std::string_view key_path, std::string_view message);
  /// A library's complaint; its key is a path below `prefix` ("" for a path from the root).
  void report(const InputError& error, std::string_view prefix = "");
  bool ok() const { return problems_.empty(); }

  /// Tells of a measured table that the file names, how it was understood: lines for `check`.
  void add_table(std::string description) { tables_.push_back(std::move(description)); }
  const std::vector<std::string>& tables() const { return tables_; }

  /// Declares the keys that a table may hold; any other is reported by throw_if_bad().
  void expect(std::string_view table_path, std::string_view key);
  /// The table may hold any key: somebody else checks them.
  void expect_any(std::string_view table_path);

  /// Throws BadInput with everything reported, in the order of the file, and every key that no
  /// reader expected.
  void throw_if_bad();

 private:
  struct Problem {
    Origin origin;
    std::string message;
  };
  void note_origins(const toml::table& table, const std::string& path, const Origin& around);
  void note_origins(const toml::node& node, const std::string& path, const Origin& around);
  void override_with(const std::string& text);
  void take_laws_over();
  void take_law_over(toml::table& parent, const std::string& path);
  void find_unknown(const toml::table& table, const std::string& path);
  void find_unknown(const toml::node& node, const std::string& path);
  std::string advice(std::string_view table_path, std::string_view key) const;

  std::string name_;
  toml::table root_;
  std::map<std::string, Origin, std::less<>> origins_;
  std::map<std::string, std::set<std::string, std::less<>>, std::less<>> expected_;
  std::set<std::string, std::less<>> any_key_;
  std::vector<Problem> problems_;
  std::vector<std::string> tables_;
};

/// The known word that a misspelt one stands for, if one is close (nearest_name()) or has the same
/// letters in another order; "" otherwise.
std::string closest(std::string_view misspelt, const std::vector<std::string_view>& known);

/// A file beside a missing one whose name is close to its; "" if there is none.
std::string similar_file(const std::filesystem::path& file);

/// "grid" + "h" = "grid.h", "" + "grid" = "grid".
std::string join_path(std::string_view table, std::string_view key);
/// "[grid]", "body[0]", "the file": a table in a sentence.
std::string table_name(std::string_view path);

}  // namespace repose::input
