#include "app/commands/chart.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/read_chart.hpp"

namespace repose::app {
namespace {

/// An option of `repose chart mpm` that sets a list of [chart].
struct ListOption {
  std::string_view name, doc;
  bool words;
};
constexpr std::array list_options{
    ListOption{"transfers", "step.transfer, as in apic,relaxed (default: all)", true},
    ListOption{"kernels", "grid.kernel (default: the scene's)", true},
    ListOption{"points-per-cell", "grid.points_per_cell (default: the scene's)", false},
    ListOption{"cells", "grid.h in m (default: 8, 4 and 2 times the scene's)", false},
    ListOption{"reference",
               "finer grid.h in m, run with the scene's own transfer and kernel alone, for the "
               "reference (default: none)",
               false},
    ListOption{"courants", "step.courant (default: 0.8,0.4,0.2,0.1 unless --dts)", false},
    ListOption{"dts", "step.dt in s, fixed steps (default: none)", false}};

struct ChartArguments {
  CommonOptions common;
  std::string what, file;
  std::optional<long> evaluations;
  std::array<std::string, list_options.size()> lists;
  bool quick = false;
};

/// chart.transfers=["apic", "relaxed"] for --transfers apic,relaxed.
std::string override_of(const ListOption& option, const std::string& list) {
  std::string value;
  for (std::size_t from = 0; from <= list.size();) {
    const std::size_t to = std::min(list.find(',', from), list.size());
    const std::string item = list.substr(from, to - from);
    value += fmt::format("{}{}", value.empty() ? "" : ", ",
                         option.words ? fmt::format("\"{}\"", item) : item);
    from = to + 1;
  }
  std::string key(option.name);
  std::replace(key.begin(), key.end(), '-', '_');
  return fmt::format("chart.{}=[{}]", key, value);
}

/// Which chart: by its name, or by the [chart] table of a file, which then stands in for FILE.
ChartKind choose(ChartArguments& arguments) {
  const auto named = std::find(chart_names.begin(), chart_names.end(), arguments.what);
  if (named != chart_names.end()) return static_cast<ChartKind>(named - chart_names.begin());
  if (!arguments.what.ends_with(".toml")) {
    const std::string near = closest(arguments.what, {chart_names.begin(), chart_names.end()});
    throw BadInput(
        {fmt::format("there is no chart '{}': {}, or a .toml file with a [chart] table{}",
                     arguments.what, fmt::join(chart_names, ", "),
                     near.empty() ? "" : fmt::format("; did you mean '{}'?", near))});
  }
  if (!arguments.file.empty())
    throw BadInput({fmt::format("repose chart {} takes no second file", arguments.what)});
  InputFile input = InputFile::read(arguments.what, arguments.common.sets);
  const ChartTable chart = read_chart(input);
  if (!chart.kind)
    throw BadInput({fmt::format("{}: [chart] needs kind = \"{}\"", to_string(input.origin("chart")),
                                fmt::join(chart_names, "\" or \""))});
  // a chart that needs no file leaves nothing but the table in its input.toml
  if (*chart.kind != ChartKind::point &&
      (*chart.kind == ChartKind::mpm || input.root().contains("fit")))
    arguments.file = arguments.what;
  if (chart.evaluations && !arguments.evaluations) arguments.evaluations = *chart.evaluations;
  if (chart.seed && arguments.common.seed == 0)
    arguments.common.seed = static_cast<std::uint64_t>(*chart.seed);
  return *chart.kind;
}

ExitCode run_chart(ChartArguments arguments) {
  const ChartKind kind = choose(arguments);
  const std::string_view name = chart_names[static_cast<std::size_t>(kind)];
  CommonOptions& common = arguments.common;
  for (std::size_t i = 0; i < list_options.size(); ++i) {
    if (arguments.lists[i].empty()) continue;
    if (kind != ChartKind::mpm)
      throw BadInput({fmt::format("--{} belongs to repose chart mpm", list_options[i].name)});
    common.sets.push_back(override_of(list_options[i], arguments.lists[i]));
  }
  if (kind == ChartKind::mpm) return chart_mpm(common, arguments.file, arguments.quick);
  for (const auto& [given, option] :
       {std::pair{arguments.quick, "--quick"}, {common.resume, "--resume"}})
    if (given) throw BadInput({fmt::format("{} belongs to repose chart mpm", option)});
  if (arguments.file.empty() && arguments.what == name && !common.sets.empty())
    throw BadInput({"--set changes the keys of a fit file: repose chart fit FIT.toml"});
  if (kind == ChartKind::fit)
    return chart_fit(common, arguments.file, arguments.evaluations.value_or(2000));
  if (!arguments.file.empty())
    throw BadInput({"repose chart point takes no file; it charts its own six paths"});
  return chart_point(common);
}

}  // namespace

Command add_chart(CLI::App& root) {
  CLI::App* verb = root.add_subcommand("chart", "Speed against accuracy");
  verb->footer(
      "Examples:\n"
      "  repose chart point          integrators of the point driver: error against time\n"
      "  repose chart fit            optimisers: objective against trials and time\n"
      "  repose chart fit FIT.toml   the same on a fit of your own\n"
      "  repose chart mpm            transfers and steps: does the run-out depend on the step?\n"
      "  repose chart mpm SCENE.toml --transfers apic,relaxed --cells 0.0125 --courants 0.4,0.1\n"
      "  repose chart FILE.toml      what the file's [chart] table says; every chart leaves such\n"
      "                              a file, input.toml, beside its results\n"
      "Writes chart.csv and chart.svg to results/chart_WHAT, and beside them error_map.csv and\n"
      "error_map.svg (point), table.csv (fit) or history.csv, history.svg and cost.svg (mpm).");
  const auto arguments = std::make_shared<ChartArguments>();
  CommonOptions& options = arguments->common;
  verb->add_option("WHAT", arguments->what, "point, fit, mpm, or a file with a [chart] table")
      ->required();
  verb->add_option("FILE", arguments->file,
                   "fit: a fit file (default: a twin experiment); mpm: a scene (default: the flat "
                   "column)");
  verb->add_option("-o,--output", options.output, "Result folder (default: results/chart_WHAT)")
      ->type_name("DIR");
  verb->add_option("--evaluations", arguments->evaluations,
                   "fit: most trials of one algorithm (default: 2000)")
      ->check(CLI::Range(1L, 10000000L).description(""))
      ->type_name("N");
  verb->add_option("--seed", options.seed, "fit: seed of the random algorithms")
      ->check(CLI::NonNegativeNumber.description(""))
      ->type_name("N");
  for (std::size_t i = 0; i < list_options.size(); ++i)
    verb->add_option(fmt::format("--{}", list_options[i].name), arguments->lists[i],
                     fmt::format("mpm: {}", list_options[i].doc))
        ->type_name("A,B,...");
  verb->add_flag("--quick", arguments->quick, "mpm: coarse cells and two steps, in seconds");
  verb->add_option("--threads", options.threads,
                   "mpm: threads of each run (default: 1, so that seconds are those of one core)")
      ->type_name("N")
      ->check(CLI::Range(0, 4096).description(""));
  verb->add_flag("--resume", options.resume,
                 "mpm: continue an interrupted run from its checkpoint; finished ones of the "
                 "same input are never repeated");
  add_set(*verb, options);
  add_quiet(*verb, options);
  return {verb, std::shared_ptr<const CommonOptions>(arguments, &arguments->common),
          [arguments] { return run_chart(*arguments); }};
}

}  // namespace repose::app
