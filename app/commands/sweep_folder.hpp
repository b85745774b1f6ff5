#pragma once
/// \file
/// The runs of one file that differ in keys of it, and the folder that they leave.

#include <filesystem>

#include <fmt/format.h>

#include "app/commands/chart.hpp"
#include "input/program_identity.hpp"
#include "io/json.hpp"
#include "io/result_folder.hpp"
#include "models/instruction_set.hpp"
#include "repose_version.hpp"
#include "study/run/finished_result.hpp"
#include "study/run/run_record.hpp"
#include "study/run/sweep_cases.hpp"

namespace repose::app {

/// What sweeps of tests and of scenes, and sensitivities, do around their runs.
class SweepFolder {
 public:
  /// kind: "sweep" or "sensitivity", as summary.json has it and the picture is called. table: where
  /// what is wrong with each run stands. further: what else the runs depend on, one line.
  SweepFolder(std::string kind, std::string table, const std::string& path,
              const input::InputFile& file, const CommonOptions& options,
              const std::string& further = "")
      : kind_(std::move(kind)),
        table_(std::move(table)),
        options_(options),
        before_(study::usage()),
        name_(std::filesystem::path(file.name()).stem().string()),
        folder_(options.output.empty() ? io::ResultFolder::default_path(name_)
                                       : std::filesystem::path(options.output)),
        claim_(folder_),
        input_(study::sweep_text(file,
                                 fmt::format("The input of this {}, by repose {}.\n# {}{}", kind_,
                                             input::program_identity(), origin_line(path, options),
                                             further.empty() ? "" : "\n# " + further))) {}

  const io::ResultFolder& folder() const { return folder_; }
  const std::string& name() const { return name_; }

  /// Is there nothing left to do?
  bool is_kept() const {
    if (!options_.resume || !study::is_finished(folder_, input_)) return false;
    if (!options_.quiet) fmt::print("{}: finished before; kept\n", folder_.path().string());
    return true;
  }
  /// Does an interrupted one of the same input go on? If not, its files are removed.
  bool begin() const {
    const bool goes_on = options_.resume && study::text_of(folder_.file("input.toml")) == input_;
    if (!goes_on) folder_.remove_old_outputs();
    folder_.remove_old_parts();
    std::error_code ignored;
    std::filesystem::remove(folder_.file("manifest.json"), ignored);
    folder_.write_file("input.toml", input_);
    return goes_on;
  }
  /// figure: makes it, only if it is wanted.
  bool draw(const std::function<report::Figure()>& figure) const {
    return !options_.no_plot && drawn(figure, folder_.file(kind_ + ".svg"));
  }
  /// Writes summary.json, tells the outcome, and returns the exit code.
  io::ExitCode end(const study::SweepCounts& counts, io::ExitCode code, io::Json further,
                   const std::string& files) const {
    const bool interrupted = code == io::ExitCode::interrupted;
    const study::Usage after = study::usage();
    io::Json summary{{"repose", version_string},
                     {"instruction_set", std::string(instruction_set())},
                     {"kind", kind_},
                     {"name", name_},
                     {"status", interrupted ? "interrupted" : "done"},
                     {"runs", counts.runs},
                     {"runs_done", counts.done},
                     {"runs_failed", counts.failed},
                     {"runs_refused", counts.refused},
                     {"wall_s", after.wall_s - before_.wall_s},
                     {"cpu_s", after.cpu_s - before_.cpu_s}};
    summary.update(further);
    folder_.write_file("summary.json", summary.dump(2) + "\n");
    if (!interrupted) {
      std::filesystem::remove(folder_.file("finished.jsonl"));
      folder_.seal();
    }
    if (options_.json) {
      fmt::print("{}\n", summary.dump());
    } else if (!options_.quiet) {
      fmt::print("{}: {} runs in {:.3g} s{}{}; {}\n", folder_.path().string(), counts.ended(),
                 after.wall_s - before_.wall_s,
                 counts.failed > 0 ? fmt::format(", {} failed", counts.failed) : "",
                 counts.refused > 0 ? fmt::format(", {} refused", counts.refused) : "", files);
      if (!counts.reasons.empty())
        fmt::print(stderr, "warning: {}: {}\n", counts.reasons.front().first,
                   counts.reasons.front().second);
      if (counts.reasons.size() > 1)
        fmt::print(stderr, "warning: {} further runs are not done; {} says why\n",
                   counts.reasons.size() - 1, table_);
    }
    if (interrupted) {
      fmt::print(stderr,
                 "interrupted after {} of {} runs; the same command with --resume continues\n",
                 counts.ended(), counts.runs);
      return code;
    }
    return counts.done == 0 ? io::ExitCode::numerical_failure : io::ExitCode::done;
  }

 private:
  std::string kind_, table_;
  const CommonOptions& options_;
  study::Usage before_;
  std::string name_;
  io::ResultFolder folder_;
  io::FolderClaim claim_;
  std::string input_;
};

}  // namespace repose::app
