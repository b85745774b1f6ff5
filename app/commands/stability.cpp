#include <algorithm>

#include <fmt/format.h>

#include "app/commands/command.hpp"
#include "app/run_record.hpp"
#include "app/stability/part.hpp"
#include "repose_version.hpp"

namespace repose::app {
namespace {

using Json = nlohmann::ordered_json;

struct StabilityArguments {
  CommonOptions common;
  std::string file;
  std::string parts;
  bool quick = false;
};

StabilityInput read(const StabilityArguments& arguments) {
  // options are keys of the file; without one, of an empty [stability]
  std::vector<std::string> sets = arguments.common.sets;
  if (!arguments.parts.empty()) {
    std::string list;
    for (std::size_t from = 0; from <= arguments.parts.size();) {
      const std::size_t to = std::min(arguments.parts.find(',', from), arguments.parts.size());
      list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ",
                          arguments.parts.substr(from, to - from));
      from = to + 1;
    }
    sets.push_back(fmt::format("stability.parts=[{}]", list));
  }
  if (arguments.quick) sets.emplace_back("stability.quick=true");
  InputFile input = arguments.file.empty()
                        ? InputFile::parse("[stability]\n", "stability.toml", sets)
                        : InputFile::read(arguments.file, sets);
  return read_stability(input);
}

Json map_part(StabilityPart part, const StabilityInput& input, PartOutput& out) {
  switch (part) {
    case StabilityPart::clay:
      return map_clay(input, out);
    case StabilityPart::mu_i:
      return map_mu_i(input, out);
    case StabilityPart::step:
      return map_step(input, out);
    case StabilityPart::mpm:
      return map_mpm(input, out);
    case StabilityPart::collapse:
      return map_collapse(input, out);
  }
  return {};
}

ExitCode run_stability(const StabilityArguments& arguments) {
  const CommonOptions& options = arguments.common;
  const StabilityInput input = read(arguments);
  const ResultFolder folder(options.output.empty() ? ResultFolder::default_path("stability")
                                                   : std::filesystem::path(options.output));
  folder.remove_old_outputs();
  folder.write_file(
      "input.toml",
      stability_text(input, arguments.file.empty() ? fmt::format("By repose {}.", version_string)
                                                   : origin_line(arguments.file, options)));
  const Usage before = usage();
  PartOutput out(folder, options.quiet || options.json);
  Json parts;
  for (const StabilityPart part : input.parts) {
    const std::string name(stability_names[static_cast<std::size_t>(part)]);
    const Usage start = usage();
    try {
      parts[name] = map_part(part, input, out);
    } catch (const InputError& error) {
      throw BadInput(
          {fmt::format("repose stability, {}: {}: {}", name, error.key(), error.what())});
    }
    parts[name]["cpu_s"] = usage().cpu_s - start.cpu_s;
  }
  const Usage after = usage();
  const Json summary{{"repose", version_string},
                     {"kind", "stability"},
                     {"status", "done"},
                     {"quick", input.quick},
                     {"cpu_s", after.cpu_s - before.cpu_s},
                     {"wall_s", after.wall_s - before.wall_s},
                     {"files", out.files()},
                     {"parts", parts}};
  folder.write_file("summary.json", summary.dump(2) + "\n");
  if (options.json)
    fmt::print("{}\n", summary.dump());
  else if (!options.quiet)
    fmt::print("{}: {}, summary.json\n", folder.path().string(), fmt::join(out.files(), ", "));
  return ExitCode::done;
}

}  // namespace

Command add_stability(CLI::App& root) {
  CLI::App* verb = root.add_subcommand("stability", "Maps of where laws and methods fail");
  verb->footer(
      "Parts: clay (Cam-Clay's update, exact and linearised), mu_i (ill-posed flow of mu(I)),\n"
      "step (largest stable steps), mpm (cell crossing, fracture, locking, ringing), collapse\n"
      "(published failures on purpose, and mended).\n"
      "Examples:\n"
      "  repose stability                     all of it for the paper's laws\n"
      "  repose stability --quick             the same on coarse maps, in seconds\n"
      "  repose stability --parts mu_i,step\n"
      "  repose stability LAW.toml            the maps of the law of the file's [law] table\n"
      "Writes tables, pictures, summary.json and input.toml to results/stability.");
  const auto arguments = std::make_shared<StabilityArguments>();
  verb->add_option("FILE.toml", arguments->file, "A file with a [law] or a [stability] table")
      ->type_name("");
  verb->add_option("--parts", arguments->parts, "Which, as in mu_i,step (default: all)")
      ->type_name("LIST");
  verb->add_flag("--quick", arguments->quick, "Coarse maps and short runs");
  verb->add_option("-o,--output", arguments->common.output,
                   "Result folder (default: results/stability)")
      ->type_name("DIR");
  add_set(*verb, arguments->common);
  add_quiet(*verb, arguments->common);
  return {verb, std::shared_ptr<const CommonOptions>(arguments, &arguments->common),
          [arguments] { return run_stability(*arguments); }};
}

}  // namespace repose::app
