#include "study/run/sweep_cases.hpp"

#include <filesystem>
#include <sstream>

namespace repose::study {

void SweepCounts::add(const std::string& run, std::string_view status, const std::string& reason) {
  ++runs;
  if (status.empty()) return;
  ++(status == "done" ? done : status == "refused" ? refused : failed);
  if (status != "done") reasons.emplace_back(run, reason);
}

SweepCounts& SweepCounts::operator+=(const SweepCounts& other) {
  runs += other.runs;
  done += other.done;
  failed += other.failed;
  refused += other.refused;
  reasons.insert(reasons.end(), other.reasons.begin(), other.reasons.end());
  return *this;
}

void require_outputs(const std::vector<std::string>& outputs, const std::set<std::string>& names,
                     const std::string& place) {
  const std::vector<std::string_view> known(names.begin(), names.end());
  std::vector<std::string> problems;
  for (const std::string& output : outputs) {
    if (names.contains(output)) continue;
    std::string near = input::closest(output, known);
    for (const std::string& name : names)  // without its unit
      if (near.empty() && name.starts_with(output + "_")) near = name;
    problems.push_back(fmt::format("{}: no run has a figure '{}'{}", place, output,
                                   near.empty()
                                       ? fmt::format("; there are {}", fmt::join(known, ", "))
                                       : fmt::format("; did you mean '{}'?", near)));
  }
  if (!problems.empty()) throw input::BadInput(std::move(problems));
}

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
