#include <fmt/core.h>

#include "app/commands/chart.hpp"
#include "input/read_chart.hpp"
#include "input/read_chart_set.hpp"
#include "input/read_stability.hpp"
#include "input/shipped_input.hpp"
#include "io/interrupt.hpp"
#include "io/json.hpp"
#include "report/page/write_report.hpp"
#include "repose_version.hpp"
#include "study/run/finished_result.hpp"
#include "study/run/run_record.hpp"

namespace repose::app {
namespace {

namespace fs = std::filesystem;
using Json = io::Json;

/// What became of a part.
struct PartRecord {
  std::string status;  ///< done | failed | interrupted
  std::string reason;  ///< of a failure that left no result
  bool kept = false;
  double cpu_s = 0.0, wall_s = 0.0;
  io::ExitCode code = io::ExitCode::done;
};

class Set {
 public:
  Set(const CommonOptions& options, const std::string& file, bool quick)
      : options_(options),
        quick_(quick),
        folder_(options.output.empty() ? io::ResultFolder::default_path("gallery")
                                       : fs::path(options.output)) {
    input::InputFile input =
        file.empty() ? input::InputFile::parse(input::shipped_chart_set(), "all.toml", options.sets)
                     : input::InputFile::read(file, options.sets);
    set_ = input::read_chart_set(input, fs::path(file).parent_path(), quick);
    std::vector<std::string> problems;
    for (const input::ChartPart& part : set_.parts) try {
        const std::size_t runs = check(part);
        lines_.push_back(fmt::format("{:<16} {}{}", part.name,
                                     input::part_kinds[static_cast<std::size_t>(part.kind)],
                                     runs > 0 ? fmt::format(", {} runs", runs) : ""));
      } catch (const input::BadInput& error) {
        for (const std::string& problem : error.problems())
          problems.push_back(
              fmt::format("{}, chart \"{}\": {}", to_string(part.origin), part.name, problem));
      } catch (const io::IoError& error) {
        problems.push_back(
            fmt::format("{}, chart \"{}\": {}", to_string(part.origin), part.name, error.what()));
      }
    if (!problems.empty()) throw input::BadInput(std::move(problems));
  }

  const std::vector<std::string>& lines() const { return lines_; }

  io::ExitCode run() {
    const io::ResultFolder folder(folder_);
    const io::FolderClaim claim(folder);
    folder.remove_old_outputs();
    folder.write_file("input.toml", fmt::format("# The charts of this folder, by repose {}.\n{}",
                                                version_string, set_.text));
    const io::InterruptGuard interrupt;
    std::vector<fs::path> made;
    for (const input::ChartPart& part : set_.parts) {
      if (interrupt.requested()) break;
      tell("[{}/{}] {}: {}", records_.size() + 1, set_.parts.size(), part.name, part.command());
      const PartRecord record = carry_out(part);
      records_.push_back(record);
      tell("[{}/{}] {}: {}", records_.size(), set_.parts.size(), part.name,
           record.kept ? "finished already"
                       : fmt::format("{} after {:.1f} s of CPU{}", record.status, record.cpu_s,
                                     record.reason.empty() ? "" : ": " + record.reason));
      if (fs::exists(folder_ / part.name / "summary.json")) made.push_back(folder_ / part.name);
      write_summary(folder, "running");
      if (!made.empty()) report::write_report(made, folder_ / "report.html", "Charts");
    }
    return finish(folder, interrupt.requested());
  }

 private:
  template <class... Args>
  void tell(fmt::format_string<Args...> format, Args&&... args) const {
    if (options_.quiet || options_.json) return;
    fmt::print("{}\n", fmt::format(format, std::forward<Args>(args)...));
    std::fflush(stdout);
  }

  CommonOptions options_of(const input::ChartPart& part) const {
    CommonOptions options = options_;
    options.output = (folder_ / part.name).string();
    options.sets = part.sets;
    return options;
  }

  /// Reads what the part will read, so that a mistake is found before anything has run. Returns how
  /// many runs of a scene it takes.
  std::size_t check(const input::ChartPart& part) const {
    const CommonOptions options = options_of(part);
    if (part.kind == input::PartKind::mpm) return check_chart_mpm(options, part.input, quick_);
    input::InputFile input = part.input.empty()
                                 ? input::InputFile::parse("[stability]\n", "chart", part.sets)
                                 : input::InputFile::read(part.input, part.sets);
    if (part.kind == input::PartKind::stability) {
      input::read_stability(input);
      return 0;
    }
    for (const auto& [key, node] : input.root()) input.expect("", key.str());
    input::read_chart(input);
    input.throw_if_bad();
    return 0;
  }

  ChartEnd make(const input::ChartPart& part, const CommonOptions& options) const {
    switch (part.kind) {
      case input::PartKind::point:
        return chart_point(options, part.input, quick_);
      case input::PartKind::fit:
        return chart_fit(options, part.input, quick_);
      case input::PartKind::mpm:
        return chart_mpm(options, part.input, quick_);
      case input::PartKind::stability:
        return stability_maps(options, part.input, quick_);
    }
    return {};
  }

  PartRecord carry_out(const input::ChartPart& part) const {
    const study::Usage before = study::usage();
    PartRecord record;
    const auto failed = [&](io::ExitCode code, const std::string& reason) {
      record.code = code;
      record.reason = reason;
      fmt::print(stderr, "{}: {}\n", part.name, reason);
    };
    try {
      const ChartEnd end = make(part, options_of(part));
      record.code = end.code;
      record.kept = end.kept;
    } catch (const input::BadInput& error) {
      failed(io::ExitCode::bad_input, error.what());
    } catch (const io::IoError& error) {
      failed(io::ExitCode::io_error, error.what());
    } catch (const std::exception& error) {
      failed(io::ExitCode::internal_error, error.what());
    }
    record.status = record.code == io::ExitCode::done          ? "done"
                    : record.code == io::ExitCode::interrupted ? "interrupted"
                                                               : "failed";
    const study::Usage after = study::usage();
    record.cpu_s = after.cpu_s - before.cpu_s;
    record.wall_s = after.wall_s - before.wall_s;
    return record;
  }

  Json write_summary(const io::ResultFolder& folder, const std::string& status) const {
    Json parts = Json::array();
    double cpu_s = 0.0, wall_s = 0.0;
    for (std::size_t i = 0; i < records_.size(); ++i) {
      const PartRecord& record = records_[i];
      parts.push_back({{"name", set_.parts[i].name},
                       {"status", record.status},
                       {"kept", record.kept},
                       {"command", set_.parts[i].command()},
                       {"cpu_s", record.cpu_s},
                       {"wall_s", record.wall_s}});
      if (!record.reason.empty()) parts.back()["reason"] = record.reason;
      cpu_s += record.cpu_s;
      wall_s += record.wall_s;
    }
    const Json summary{
        {"repose", version_string},    {"kind", "chart_set"}, {"status", status}, {"quick", quick_},
        {"charts", set_.parts.size()}, {"cpu_s", cpu_s},      {"wall_s", wall_s}, {"parts", parts}};
    folder.write_file("summary.json", summary.dump(2) + "\n");
    return summary;
  }

  io::ExitCode finish(const io::ResultFolder& folder, bool interrupted) const {
    io::ExitCode code = io::ExitCode::done;
    std::size_t kept = 0, failed = 0;
    for (const PartRecord& record : records_) {
      kept += record.kept ? 1 : 0;
      failed += record.status == "failed" ? 1 : 0;
      if (code == io::ExitCode::done) code = record.code;
    }
    if (interrupted) code = io::ExitCode::interrupted;
    const Json summary = write_summary(folder, interrupted  ? "interrupted"
                                               : failed > 0 ? "failed"
                                                            : "done");
    if (options_.json) fmt::print("{}\n", summary.dump());
    tell("{}: {} of {} charts, {} kept, {} failed, {:.0f} s of CPU; report.html shows them",
         folder_.string(), records_.size(), set_.parts.size(), kept, failed,
         summary["cpu_s"].get<double>());
    if (interrupted && !options_.quiet && !options_.json)
      fmt::print(stderr, "interrupted; the same command with --resume continues\n");
    return code;
  }

  const CommonOptions& options_;
  bool quick_;
  fs::path folder_;
  input::ChartSet set_;
  std::vector<std::string> lines_;  ///< a part each: what it takes
  std::vector<PartRecord> records_;
};

}  // namespace

io::ExitCode chart_set(const CommonOptions& options, const std::string& file, bool quick) {
  return Set(options, file, quick).run();
}

std::vector<std::string> check_chart_set(const CommonOptions& options, const std::string& file) {
  return Set(options, file, false).lines();
}

}  // namespace repose::app
