#include "input/write_keys.hpp"

#include <fmt/core.h>

#include "input/input_file.hpp"
#include "input/key_info.hpp"
#include "input/toml_text.hpp"

namespace repose::input {
namespace {

/// Lines of this table first, those of the tables below it after them, as TOML wants it.
class WriteKeys final : public Keys {
 public:
  explicit WriteKeys(std::string path) : path_(std::move(path)) {}
  std::string text() const { return lines_ + below_; }

  void number(const Key& key, double& x) override { line(key, toml_number(x)); }
  void number(const Key& key, std::optional<double>& x) override {
    if (x) line(key, toml_number(*x));
  }
  void integer(const Key& key, Limits, std::int64_t& x) override { line(key, std::to_string(x)); }
  void integer(const Key& key, Limits, std::optional<std::int64_t>& x) override {
    if (x) line(key, std::to_string(*x));
  }
  void boolean(const Key& key, bool& x) override { line(key, x ? "true" : "false"); }
  void text(const Key& key, std::string& x) override {
    if (!x.empty()) line(key, toml_string(x));
  }
  void word(const Key& key, std::span<const std::string_view> words, std::size_t& x) override {
    line(key, toml_string(words[x]));
  }
  void word(const Key& key, std::span<const std::string_view> words,
            std::optional<std::size_t>& x) override {
    if (x) line(key, toml_string(words[*x]));
  }
  void vector(const Key& key, std::size_t axes, std::array<double, 3>& x) override {
    line(key, toml_vector(x, axes));
  }
  void components(const Key& key, std::optional<std::array<double, 6>>& x) override {
    if (x) line(key, list_of(*x, toml_number));
  }
  void number_list(const Key& key, std::vector<double>& x) override {
    if (!x.empty()) line(key, list_of(x, toml_number));
  }
  void word_list(const Key& key, std::span<const std::string_view> words,
                 std::vector<std::size_t>& x) override {
    if (!x.empty()) line(key, list_of(x, [&](std::size_t i) { return toml_string(words[i]); }));
  }
  void text_list(const Key& key, std::vector<std::string>& x) override {
    if (!x.empty()) line(key, list_of(x, toml_string));
  }
  void table(const Key& key, const std::function<void(Keys&)>& below) override {
    add_table(key, "[{}]", below);
  }
  void tables(const Key& key, std::size_t count, const std::function<void(std::size_t)>&,
              const std::function<void(Keys&, std::size_t)>& entry) override {
    for (std::size_t i = 0; i < count; ++i)
      add_table(key, "[[{}]]", [&](Keys& keys) { entry(keys, i); });
  }
  void value(const Key& key, const std::function<void(TomlReader&)>&,
             const std::function<std::string()>& write, const KeyInfo&) override {
    if (const std::string text = write(); !text.empty()) line(key, text);
  }
  void others(const std::function<void(TomlReader&)>&, const std::function<std::string()>& write,
              const std::vector<KeyInfo>&) override {
    lines_ += write();
  }

 private:
  void line(const Key& key, const std::string& value) {
    if (key.applies) lines_ += key_line(key.name, value, unit_and_doc(key.unit, key.doc));
  }
  void add_table(const Key& key, const char* heading, const std::function<void(Keys&)>& fill) {
    if (!key.applies) return;
    WriteKeys keys(join_path(path_, key.name));
    fill(keys);
    if (const std::string text = keys.text(); !text.empty())
      below_ += "\n" + fmt::format(fmt::runtime(heading), keys.path_) + "\n" + text;
  }
  template <class List, class F>
  static std::string list_of(const List& list, F&& text_of) {
    std::string text;
    for (const auto& x : list) text += (text.empty() ? "" : ", ") + text_of(x);
    return "[" + text + "]";
  }

  std::string path_, lines_, below_;
};

}  // namespace

std::string write_keys(const std::function<void(Keys&)>& keys) {
  WriteKeys write("");
  keys(write);
  return write.text();
}

std::string key_line(std::string_view key, std::string_view value, std::string_view comment) {
  const std::string text = fmt::format("{} = {}", key, value);
  return comment.empty() ? text + "\n" : fmt::format("{:<27} # {}\n", text, comment);
}

std::string unit_and_doc(std::string_view unit, std::string_view doc) {
  if (unit.empty() || unit == "-") return std::string(doc);
  return doc.empty() ? std::string(unit) : fmt::format("{}, {}", unit, doc);
}

}  // namespace repose::input
