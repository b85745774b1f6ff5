#include "report/page/write_report.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "report/page/page.hpp"
#include "report/page/read_result.hpp"

namespace repose::report {
namespace {

namespace fs = std::filesystem;
using Json = io::Json;

/// Two folders of one name are told apart by the paths that were given.
void tell_apart(std::vector<Json>& results) {
  std::vector<std::string> labels;
  for (const Json& result : results) labels.push_back(result["label"].get<std::string>());
  for (std::size_t i = 0; i < results.size(); ++i)
    if (std::count(labels.begin(), labels.end(), labels[i]) > 1)
      results[i]["label"] = results[i]["path"];
  // a page that is sent to others need not tell where its results lay
  for (Json& result : results) result.erase("path");
}

std::string title_of(const std::vector<Json>& results) {
  if (results.size() == 1) return results.front()["label"].get<std::string>();
  if (results.size() == 2)
    return fmt::format("{} and {}", results[0]["label"].get<std::string>(),
                       results[1]["label"].get<std::string>());
  return fmt::format("{} and {} more results", results[0]["label"].get<std::string>(),
                     results.size() - 1);
}

}  // namespace

WrittenReport write_report(const std::vector<fs::path>& folders, const fs::path& page,
                           const std::string& title) {
  std::vector<Json> results;
  std::vector<fs::path> seen;
  for (const fs::path& folder : folders) {
    std::error_code error;
    const fs::path whole = fs::weakly_canonical(folder, error);
    if (std::find(seen.begin(), seen.end(), whole) != seen.end()) continue;
    seen.push_back(whole);
    results.push_back(read_result(folder));
  }
  tell_apart(results);
  const std::string text = report_page(results, title.empty() ? title_of(results) : title);
  const fs::path around = page.parent_path();
  std::error_code error;
  if (!around.empty()) fs::create_directories(around, error);
  if (error) throw io::IoError(around, "cannot create the folder", error.value());
  io::write_atomically(page, text);
  return {results.size(), text.size()};
}

}  // namespace repose::report
