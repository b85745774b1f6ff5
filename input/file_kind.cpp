#include "input/file_kind.hpp"

#include <array>

#include <fmt/core.h>

namespace repose::input {
namespace {

struct KindInfo {
  FileKind kind;
  std::string_view table, what, verb;
};
constexpr std::array kinds{
    KindInfo{FileKind::scene, "scene", "a scene", "run"},
    KindInfo{FileKind::point_test, "test", "a point test", "point"},
    KindInfo{FileKind::fit, "fit", "a fit", "fit"},
    KindInfo{FileKind::stability, "stability", "a set of stability maps", "stability"},
    KindInfo{FileKind::benchmark, "case", "a validation case", "validate"}};

const KindInfo& info_of(FileKind kind) {
  for (const KindInfo& info : kinds)
    if (info.kind == kind) return info;
  return kinds.front();
}

[[noreturn]] void refuse(const InputFile& file, std::string_view key, std::string_view why) {
  throw BadInput({fmt::format("{}: {}", to_string(file.origin(key)), why)});
}

}  // namespace

FileKind kind_of(const InputFile& file) {
  const KindInfo* found = nullptr;
  for (const KindInfo& info : kinds) {
    if (!file.root().contains(info.table)) continue;
    if (found != nullptr)
      refuse(file, info.table,
             fmt::format("[{}] makes this {}, and [{}] makes it {}: a file is one of them",
                         info.table, info.what, found->table, found->what));
    found = &info;
  }
  if (found == nullptr) {
    std::vector<std::string_view> names;
    for (const KindInfo& info : kinds) names.push_back(info.table);
    for (const auto& [key, node] : file.root())
      if (const std::string near = closest(key.str(), names); !near.empty())
        refuse(file, key.str(),
               fmt::format("unknown table '{}'; did you mean '{}'?", key.str(), near));
    refuse(file, "",
           "a file needs [scene] (a scene), [test] (a point test), [fit] (a fit), [stability] "
           "(stability maps) or [case] (a validation case)");
  }
  return found->kind;
}

void require_kind(const InputFile& file, FileKind wanted, std::string_view verb) {
  const KindInfo& is = info_of(kind_of(file));
  if (is.kind != wanted)
    refuse(file, is.table,
           fmt::format("this is {} ([{}]), and `repose {}` takes {} ([{}])", is.what, is.table,
                       verb, info_of(wanted).what, info_of(wanted).table));
}

}  // namespace repose::input
