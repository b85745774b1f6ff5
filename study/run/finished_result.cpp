#include "study/run/finished_result.hpp"

#include <fstream>
#include <sstream>

#include "study/run/run_record.hpp"

namespace repose::study {

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return in ? std::move(text).str() : "";
}

bool is_finished(const io::ResultFolder& folder, std::string_view input) {
  return text_of(folder.file("input.toml")) == input &&
         noted_status(folder.file("summary.json")) == "done";
}

}  // namespace repose::study
