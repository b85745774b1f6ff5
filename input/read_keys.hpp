#pragma once

#include "input/keys.hpp"
#include "input/toml_reader.hpp"

namespace repose::input {

/// Reads one table of a file into the variables that keys land in. Problems are reported to the
/// file; a variable whose key is broken or missing holds a stand-in until
/// InputFile::throw_if_bad().
class ReadKeys final : public Keys {
 public:
  explicit ReadKeys(TomlReader table) : table_(std::move(table)) {}

  using Keys::integer;
  void number(const Key& key, double& x) override;
  void number(const Key& key, std::optional<double>& x) override;
  void integer(const Key& key, Limits limits, std::int64_t& x) override;
  void integer(const Key& key, Limits limits, std::optional<std::int64_t>& x) override;
  void boolean(const Key& key, bool& x) override;
  void text(const Key& key, std::string& x) override;
  void word(const Key& key, std::span<const std::string_view> words, std::size_t& x) override;
  void word(const Key& key, std::span<const std::string_view> words,
            std::optional<std::size_t>& x) override;
  void vector(const Key& key, std::size_t axes, std::array<double, 3>& x) override;
  void components(const Key& key, std::optional<std::array<double, 6>>& x) override;
  void number_list(const Key& key, std::vector<double>& x) override;
  void word_list(const Key& key, std::span<const std::string_view> words,
                 std::vector<std::size_t>& x) override;
  void text_list(const Key& key, std::vector<std::string>& x) override;
  void table(const Key& key, const std::function<void(Keys&)>& below) override;
  void tables(const Key& key, std::size_t count, const std::function<void(std::size_t)>& resize,
              const std::function<void(Keys&, std::size_t)>& entry) override;
  void value(const Key& key, const std::function<void(TomlReader&)>& read,
             const std::function<std::string()>& write, const KeyInfo& info) override;
  void others(const std::function<void(TomlReader&)>& read,
              const std::function<std::string()>& write, const std::vector<KeyInfo>& info) override;
  TomlReader* reader() override { return &table_; }

 private:
  /// Whether the key is to be read; one that does not apply here is reported if it is given.
  bool wanted(const Key& key);

  TomlReader table_;
};

}  // namespace repose::input
