#include "input/key_info.hpp"

#include <algorithm>

#include "input/toml_text.hpp"

namespace repose::input {
namespace {

class DescribeKeys final : public Keys {
 public:
  std::vector<KeyInfo> take() { return std::move(list_); }

  void number(const Key& key, double& x) override { add(key, ValueKind::number, toml_number(x)); }
  void number(const Key& key, std::optional<double>& x) override {
    add(key, ValueKind::number, x ? toml_number(*x) : "");
  }
  void integer(const Key& key, Limits limits, std::int64_t& x) override {
    add(key, ValueKind::integer, std::to_string(x)).limits = limits;
  }
  void integer(const Key& key, Limits limits, std::optional<std::int64_t>& x) override {
    add(key, ValueKind::integer, x ? std::to_string(*x) : "").limits = limits;
  }
  void boolean(const Key& key, bool& x) override {
    add(key, ValueKind::boolean, x ? "true" : "false");
  }
  void text(const Key& key, std::string& x) override {
    add(key, ValueKind::text, x.empty() ? "" : toml_string(x));
  }
  void word(const Key& key, std::span<const std::string_view> words, std::size_t& x) override {
    name_words(add(key, ValueKind::word, toml_string(words[x])), words);
  }
  void word(const Key& key, std::span<const std::string_view> words,
            std::optional<std::size_t>& x) override {
    name_words(add(key, ValueKind::word, x ? toml_string(words[*x]) : ""), words);
  }
  void vector(const Key& key, std::size_t axes, std::array<double, 3>& x) override {
    KeyInfo& info = add(key, ValueKind::number_list, toml_vector(x, axes));
    info.least = std::min(info.least == 1 ? axes : info.least, axes);
    info.most = std::max(info.most, axes);
  }
  void components(const Key& key, std::optional<std::array<double, 6>>&) override {
    KeyInfo& info = add(key, ValueKind::number_list, "");
    info.least = info.most = 6;
  }
  void number_list(const Key& key, std::vector<double>&) override {
    add(key, ValueKind::number_list, "");
  }
  void word_list(const Key& key, std::span<const std::string_view> words,
                 std::vector<std::size_t>&) override {
    name_words(add(key, ValueKind::word_list, ""), words);
  }
  void text_list(const Key& key, std::vector<std::string>&) override {
    add(key, ValueKind::text_list, "");
  }
  void table(const Key& key, const std::function<void(Keys&)>& below) override {
    include(add(key, ValueKind::table, "").below, describe_keys(below));
  }
  void tables(const Key& key, std::size_t, const std::function<void(std::size_t)>& resize,
              const std::function<void(Keys&, std::size_t)>& entry) override {
    resize(1);
    include(add(key, ValueKind::tables, "").below,
            describe_keys([&](Keys& keys) { entry(keys, 0); }));
  }
  void value(const Key& key, const std::function<void(TomlReader&)>&,
             const std::function<std::string()>& write, const KeyInfo& info) override {
    KeyInfo& own = add(key, info.kind, write());
    const KeyInfo named = own;
    own = info;
    own.name = named.name;
    own.unit = named.unit;
    own.doc = named.doc;
    own.required = named.required;
    own.only = named.only;
    own.fallback = named.required ? "" : named.fallback;
  }
  void others(const std::function<void(TomlReader&)>&, const std::function<std::string()>&,
              const std::vector<KeyInfo>& info) override {
    include(list_, info);
  }
  bool describes() const override { return true; }

 private:
  /// A key that several branches have is one.
  KeyInfo& add(const Key& key, ValueKind kind, const std::string& fallback) {
    const auto found = std::find_if(list_.begin(), list_.end(),
                                    [&](const KeyInfo& k) { return k.name == key.name; });
    if (found != list_.end()) return *found;
    KeyInfo& info = list_.emplace_back();
    info.name = key.name;
    info.kind = kind;
    info.unit = key.unit;
    info.doc = key.doc;
    info.range = key.range;
    info.required = key.presence == required && key.only.empty();
    info.fallback = key.presence == required || !key.only.empty() ? "" : fallback;
    info.only = key.only;
    return info;
  }
  static void name_words(KeyInfo& info, std::span<const std::string_view> words) {
    if (info.words.empty()) info.words.assign(words.begin(), words.end());
  }
  static void include(std::vector<KeyInfo>& list, const std::vector<KeyInfo>& more) {
    for (const KeyInfo& info : more) {
      const bool known = std::any_of(list.begin(), list.end(),
                                     [&](const KeyInfo& k) { return k.name == info.name; });
      if (!known) list.push_back(info);
    }
  }

  std::vector<KeyInfo> list_;
};

}  // namespace

std::vector<KeyInfo> describe_keys(const std::function<void(Keys&)>& keys) {
  DescribeKeys describe;
  keys(describe);
  return describe.take();
}

}  // namespace repose::input
