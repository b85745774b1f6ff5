#include "study/run/sweep_cases.hpp"

#include <filesystem>
#include <sstream>

namespace repose::study {

std::string sweep_text(const input::InputFile& file, const std::string& comment) {
  toml::table table = file.root();
  if (toml::table* sweep = table["sweep"].as_table())
    if (const auto name = (*sweep)["table"].value<std::string>())
      sweep->insert_or_assign("table", std::filesystem::absolute(
                                           std::filesystem::path(file.name()).parent_path() / *name)
                                           .lexically_normal()
                                           .string());
  std::ostringstream text;
  text << "# " << comment << "\n" << table << "\n";
  return std::move(text).str();
}

}  // namespace repose::study
