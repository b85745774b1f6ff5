#include "study/run/scene_sweep.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/interrupt.hpp"
#include "io/number_text.hpp"
#include "io/result_folder.hpp"

namespace repose::study {

std::string SceneSweep::folder_name(std::size_t run) { return fmt::format("{:04}", run); }

io::ExitCode SceneSweep::run(const io::ResultFolder& folder, int threads, std::uint64_t seed,
                             bool resume, const std::function<void(std::size_t)>& told) {
  const io::InterruptGuard interrupt;
  for (std::size_t k = 0; k < cases_.size(); ++k) {
    SceneCase& one = cases_[k];
    if (interrupt.requested()) return io::ExitCode::interrupted;
    if (!one.file) {
      one.summary.status = "refused";
      one.summary.reason = one.refusal;
    } else {
      RunRequest request;
      request.file = *one.file;
      request.input = one.input;
      request.folder = folder.file("runs") / folder_name(k + 1);
      request.threads = threads;
      request.seed = seed;
      request.quiet = true;
      const io::ResultFolder there(request.folder);
      if (resume && is_finished(there, one.input)) {
        tidy_finished(there);
      } else {
        request.resume = resume && text_of(there.file("input.toml")) == one.input;
        if (run_scene(request) == io::ExitCode::interrupted) return io::ExitCode::interrupted;
      }
      one.summary = read_summary(there.file("summary.json"));
    }
    folder.write_file("sweep.csv", table());
    told(k + 1);
  }
  return io::ExitCode::done;
}

std::string SceneSweep::table() const {
  std::vector<std::string> names;
  for (const SceneCase& one : cases_)
    for (const auto& [name, value] : one.summary.figures)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  std::string text = "run";
  for (const std::string& key : keys_) text += "," + io::csv_cell(key);
  text += ",status";
  for (const std::string& name : names) text += "," + name;
  text += ",reason\n";
  for (std::size_t k = 0; k < cases_.size(); ++k) {
    const SceneCase& one = cases_[k];
    if (one.summary.status.empty()) continue;
    text += fmt::format("{}", k + 1);
    for (const std::string& value : one.values) text += "," + io::csv_cell(value);
    text += "," + one.summary.status;
    for (const std::string& name : names) {
      const auto found = one.summary.figures.find(name);
      text += found == one.summary.figures.end() ? "," : fmt::format(",{}", found->second);
    }
    text += "," + io::csv_cell(one.summary.reason) + "\n";
  }
  return text;
}

std::size_t SceneSweep::count(std::string_view status) const {
  return static_cast<std::size_t>(
      std::count_if(cases_.begin(), cases_.end(),
                    [&](const SceneCase& one) { return one.summary.status == status; }));
}

}  // namespace repose::study
