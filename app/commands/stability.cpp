#include <algorithm>

#include <fmt/format.h>

#include "app/commands/chart.hpp"
#include "io/interrupt.hpp"
#include "io/json.hpp"
#include "report/stability/pictures.hpp"
#include "repose_version.hpp"
#include "study/run/finished_result.hpp"
#include "study/run/run_record.hpp"

namespace repose::app {
namespace {

using Json = io::Json;

struct StabilityArguments {
  CommonOptions common;
  std::string file;
  std::string parts;
  bool quick = false;
};

/// stability.parts=["mu_i", "step"] of --parts mu_i,step: options are keys of the file.
std::string parts_override(const std::string& parts) {
  std::string list;
  for (std::size_t from = 0; from <= parts.size();) {
    const std::size_t to = std::min(parts.find(',', from), parts.size());
    list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", parts.substr(from, to - from));
    from = to + 1;
  }
  return fmt::format("stability.parts=[{}]", list);
}

/// The figures of parts that an interrupted run on the same input had done, and whose files are as
/// they were written; null if there are none.
Json parts_done(const io::ResultFolder& folder, const std::string& input) {
  if (study::text_of(folder.file("input.toml")) != input) return {};
  std::vector<std::string> summary_file{"summary.json"};
  if (!folder.damage(summary_file).empty()) return {};
  const auto summary = Json::try_parse(study::text_of(folder.file("summary.json")));
  Json parts = summary ? summary->value("parts", Json()) : Json();
  std::vector<std::string> damaged;
  if (parts.is_object())
    for (const auto& [name, figures] : parts.items())
      if (const std::string why =
              folder.damage(figures.value("files", std::vector<std::string>{"of the part"}));
          !why.empty()) {
        fmt::print(stderr, "warning: {}: {}, so {} is made again\n", folder.path().string(), why,
                   name);
        damaged.push_back(name);
      }
  for (const std::string& name : damaged) parts.erase(name);
  return parts;
}

class Maps {
 public:
  Maps(const CommonOptions& options, const std::string& file, bool quick)
      : options_(options),
        folder_(options.output.empty() ? io::ResultFolder::default_path("stability")
                                       : std::filesystem::path(options.output)) {
    std::vector<std::string> sets = options.sets;
    if (quick) sets.emplace_back("stability.quick=true");
    input::InputFile given = file.empty()
                                 ? input::InputFile::parse("[stability]\n", "stability.toml", sets)
                                 : input::InputFile::read(file, sets);
    input_ = input::read_stability(given);
    text_ = input::stability_text(
        input_, file.empty()
                    ? fmt::format("By repose {}.", version_string)
                    : fmt::format("{}, by repose {}.", origin_line(file, options), version_string));
  }

  ChartEnd run() {
    const io::FolderClaim claim(folder_);
    folder_.remove_old_parts();
    if (options_.resume && study::is_finished(folder_, text_)) return {io::ExitCode::done, true};
    if (options_.resume) parts_ = parts_done(folder_, text_);
    if (parts_.is_null()) folder_.remove_old_outputs();
    folder_.write_file("input.toml", text_);
    const io::InterruptGuard interrupt;
    for (const input::StabilityPart part : input_.parts) {
      if (interrupt.requested()) break;
      make(part);
      write_summary("interrupted");
    }
    const bool done =
        std::all_of(input_.parts.begin(), input_.parts.end(), [&](input::StabilityPart part) {
          return parts_.contains(
              std::string(input::stability_names[static_cast<std::size_t>(part)]));
        });
    const Json summary = write_summary(done ? "done" : "interrupted");
    if (options_.json)
      fmt::print("{}\n", summary.dump());
    else if (!options_.quiet)
      fmt::print("{}: {}, summary.json\n", folder_.path().string(), fmt::join(files(), ", "));
    return {done ? io::ExitCode::done : io::ExitCode::interrupted};
  }

 private:
  void make(input::StabilityPart part) {
    const std::string name(input::stability_names[static_cast<std::size_t>(part)]);
    if (parts_.contains(name)) return;
    const study::Usage start = study::usage();
    std::vector<std::string> files;
    Json figures;
    try {
      figures = map_part(part, files);
    } catch (const InputError& error) {
      throw input::BadInput(
          {fmt::format("repose stability, {}: {}: {}", name, error.key(), error.what())});
    }
    const study::Usage end = study::usage();
    figures["cpu_s"] = end.cpu_s - start.cpu_s;
    figures["wall_s"] = end.wall_s - start.wall_s;
    figures["files"] = files;
    parts_[name] = std::move(figures);
  }

  /// The figures of a part, once it is written; `files` gets the names.
  Json map_part(input::StabilityPart part, std::vector<std::string>& files) {
    switch (part) {
      case input::StabilityPart::clay: {
        const study::ClayMaps maps = study::map_clay(input_);
        return leave(maps, report::clay_figures(maps), study::words_of(maps), files);
      }
      case input::StabilityPart::mu_i: {
        const study::GrainMaps maps = study::map_mu_i(input_);
        return leave(maps, report::mu_i_figures(maps), study::words_of(maps), files);
      }
      case input::StabilityPart::step: {
        const study::StepMaps maps = study::map_step(input_);
        return leave(maps, report::step_figures(maps), study::words_of(maps), files);
      }
      case input::StabilityPart::mpm: {
        const study::FailureMaps maps = study::map_mpm(input_);
        return leave(maps, report::mpm_figures(maps),
                     "mpm: cell crossing, fracture, locking, ringing in mpm_failures.csv", files);
      }
      case input::StabilityPart::collapse: {
        const study::CollapseMaps maps = study::map_collapse(
            input_, {[&](const study::ClayCollapse& run) { tell(study::words_of(run)); },
                     [&](const study::GrainCollapse& run) { tell(study::words_of(run)); }});
        return leave(maps, report::collapse_figures(maps), "", files);
      }
    }
    return {};
  }

  /// Writes tables and pictures, says the words, and returns the part's figures.
  Json leave(const study::PartMaps& maps, const std::vector<report::Figure>& pictures,
             const std::string& words, std::vector<std::string>& files) const {
    for (std::size_t i = 0; i < maps.tables.size(); ++i) {
      files.push_back(maps.tables[i].name + ".csv");
      folder_.write_file(files.back(), maps.tables[i].csv);
      const std::string picture = maps.tables[i].name + ".svg";
      if (!options_.no_plot && drawn(pictures.at(i), folder_.file(picture)))
        files.push_back(picture);
    }
    tell(words);
    return maps.figures;
  }

  void tell(const std::string& words) const {
    if (options_.quiet || options_.json || words.empty()) return;
    fmt::print("{}\n", words);
    std::fflush(stdout);
  }

  std::vector<std::string> files() const {
    std::vector<std::string> list;
    for (const auto& [name, figures] : parts_.items())
      for (const auto& file : figures["files"]) list.push_back(file.get<std::string>());
    return list;
  }

  Json write_summary(const char* status) {
    // in the order that they were asked for, whichever was made again
    Json ordered = Json::object();
    for (const input::StabilityPart part : input_.parts) {
      const std::string name(input::stability_names[static_cast<std::size_t>(part)]);
      if (parts_.contains(name)) ordered[name] = parts_[name];
    }
    parts_ = std::move(ordered);
    double cpu_s = 0.0, wall_s = 0.0;
    for (const auto& [name, figures] : parts_.items()) {
      cpu_s += figures["cpu_s"].get<double>();
      wall_s += figures["wall_s"].get<double>();
    }
    const Json summary{{"repose", version_string}, {"kind", "stability"}, {"status", status},
                       {"quick", input_.quick},    {"cpu_s", cpu_s},      {"wall_s", wall_s},
                       {"files", files()},         {"parts", parts_}};
    folder_.write_file("summary.json", summary.dump(2) + "\n");
    folder_.seal();
    return summary;
  }

  const CommonOptions& options_;
  io::ResultFolder folder_;
  input::StabilityInput input_;
  std::string text_;
  Json parts_;
};

}  // namespace

ChartEnd stability_maps(const CommonOptions& options, const std::string& file, bool quick) {
  return Maps(options, file, quick).run();
}

Command add_stability(CLI::App& root) {
  Verb verb(root, "stability", "Maps of where laws and methods fail");
  verb.footer(
      "Parts: clay (Cam-Clay's update, exact and linearised), mu_i (ill-posed flow of mu(I)),\n"
      "step (largest stable steps), mpm (cell crossing, fracture, locking, ringing), collapse\n"
      "(published failures on purpose, and mended).\n"
      "Examples:\n"
      "  repose stability                     all of it for the paper's laws\n"
      "  repose stability --quick             the same on coarse maps, in seconds\n"
      "  repose stability --parts mu_i,step\n"
      "  repose stability --resume            go on after an interrupt, part by part\n"
      "  repose stability LAW.toml            the maps of the law of the file's [law] table\n"
      "Writes tables, pictures, summary.json and input.toml to results/stability.");
  const auto arguments = std::make_shared<StabilityArguments>();
  verb.option("FILE.toml", arguments->file, "A file with a [law] or a [stability] table", "");
  verb.option("--parts", arguments->parts, "Which, as in mu_i,step (default: all)", "LIST");
  verb.flag("--quick", arguments->quick, "Coarse maps and short runs");
  verb.option("-o,--output", arguments->common.output, "Result folder (default: results/stability)",
              "DIR");
  verb.flag("--resume", arguments->common.resume,
            "Keep the parts that are finished from the same input");
  add_set(verb, arguments->common);
  add_quiet(verb, arguments->common);
  add_no_plot(verb, arguments->common);
  return {verb.app(), std::shared_ptr<const CommonOptions>(arguments, &arguments->common),
          [arguments] {
            CommonOptions options = arguments->common;
            if (!arguments->parts.empty()) options.sets.push_back(parts_override(arguments->parts));
            return told(stability_maps(options, arguments->file, arguments->quick), options);
          }};
}

}  // namespace repose::app
