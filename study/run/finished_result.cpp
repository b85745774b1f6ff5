#include "study/run/finished_result.hpp"

#include <charconv>
#include <fstream>
#include <sstream>

#include <fmt/core.h>

#include "io/json.hpp"
#include "io/progress.hpp"
#include "study/run/run_record.hpp"

namespace repose::study {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return in ? std::move(text).str() : "";
}

bool is_finished(const io::ResultFolder& folder, std::string_view input) {
  if (text_of(folder.file("input.toml")) != input ||
      noted_status(folder.file("summary.json")) != "done")
    return false;
  const std::string damage = folder.damage();
  if (damage.empty()) return true;
  io::warn_of_damage(folder.path().string(), damage, "so this result is made again");
  return false;
}

void tidy_finished(const io::ResultFolder& folder) {
  namespace fs = std::filesystem;
  if (!fs::exists(folder.file(".repose-lock")) && !fs::exists(folder.checkpoint()) &&
      !fs::exists(folder.previous_checkpoint()))
    return;                             // it may lie where nothing can be written
  const io::FolderClaim claim(folder);  // takes the lock with it when it ends
  folder.remove_checkpoints();
}

RunSummary read_summary(const std::filesystem::path& file) {
  const auto json = io::Json::try_parse(text_of(file));
  if (!json || !json->is_object()) throw io::IoError(file, "is not the summary of a run");
  RunSummary summary;
  summary.status = json->value("status", "");
  summary.reason = json->value("reason", "");
  summary.warnings = json->value("warnings", summary.warnings);
  for (const auto& [name, value] : json->items())
    if (value.is_number()) summary.figures[name] = value.get<double>();
  return summary;
}

NumberTable read_numbers(const std::filesystem::path& file) {
  const std::string text = text_of(file);
  NumberTable table;
  std::vector<std::vector<double>*> columns;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end && *at != '\n') {
    const char* const name = at;
    while (at != end && *at != ',' && *at != '\n') ++at;
    columns.push_back(&table[std::string(name, at)]);
    if (at != end && *at == ',') ++at;
  }
  if (columns.empty()) throw io::IoError(file, "cannot read");
  while (at != end && ++at != end)
    for (std::size_t k = 0; k < columns.size(); ++k) {
      double x = 0.0;
      const auto [next, error] = std::from_chars(at, end, x);
      const bool last = k + 1 == columns.size();
      if (error != std::errc() || (next == end ? !last : *next != (last ? '\n' : ',')))
        throw io::IoError(file, "has a row that is too short, or a cell that is no number");
      columns[k]->push_back(x);
      at = last ? next : next + 1;
    }
  return table;
}

}  // namespace repose::study
