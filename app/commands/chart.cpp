#include "app/commands/chart.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "input/read_chart.hpp"
#include "input/read_chart_set.hpp"
#include "report/plot/gnuplot.hpp"

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

constexpr std::string_view all = "all";

/// Which chart: by its name, or by the [chart] table of a file, which then stands in for FILE;
/// absent: a set of charts.
std::optional<input::ChartKind> choose(ChartArguments& arguments) {
  const auto no_second_file = [&] {
    if (!arguments.file.empty())
      throw input::BadInput({fmt::format("repose chart {} takes no second file", arguments.what)});
  };
  if (arguments.what == all) {
    no_second_file();
    return {};
  }
  const auto named =
      std::find(input::chart_names.begin(), input::chart_names.end(), arguments.what);
  if (named != input::chart_names.end())
    return static_cast<input::ChartKind>(named - input::chart_names.begin());
  if (!arguments.what.ends_with(".toml")) {
    std::vector<std::string_view> names(input::chart_names.begin(), input::chart_names.end());
    names.push_back(all);
    const std::string near = input::closest(arguments.what, names);
    throw input::BadInput({fmt::format(
        "there is no chart '{}': {}, or a .toml file with a [chart] table{}", arguments.what,
        fmt::join(names, ", "), near.empty() ? "" : fmt::format("; did you mean '{}'?", near))});
  }
  no_second_file();
  arguments.file = arguments.what;
  input::InputFile input = input::InputFile::read(arguments.what, arguments.common.sets);
  if (input::is_chart_set(input)) return {};
  const input::ChartTable chart = input::read_chart(input);
  if (!chart.kind)
    throw input::BadInput(
        {fmt::format("{}: [chart] needs kind = \"{}\"", to_string(input.origin("chart")),
                     fmt::join(input::chart_names, "\" or \""))});
  return *chart.kind;
}

io::ExitCode run_chart(ChartArguments arguments) {
  const std::optional<input::ChartKind> kind = choose(arguments);
  CommonOptions& common = arguments.common;
  for (std::size_t i = 0; i < list_options.size(); ++i) {
    if (arguments.lists[i].empty()) continue;
    if (kind != input::ChartKind::mpm)
      throw input::BadInput(
          {fmt::format("--{} belongs to repose chart mpm", list_options[i].name)});
    common.sets.push_back(override_of(list_options[i], arguments.lists[i]));
  }
  if (!kind) return chart_set(common, arguments.file, arguments.quick);
  if (arguments.evaluations) {
    if (kind != input::ChartKind::fit)
      throw input::BadInput({"--evaluations belongs to repose chart fit"});
    common.sets.push_back(fmt::format("chart.evaluations={}", *arguments.evaluations));
  }
  switch (*kind) {
    case input::ChartKind::mpm:
      return told(chart_mpm(common, arguments.file, arguments.quick), common);
    case input::ChartKind::fit:
      return told(chart_fit(common, arguments.file, arguments.quick), common);
    case input::ChartKind::point:
      break;
  }
  if (!arguments.file.empty() && arguments.file != arguments.what)
    throw input::BadInput({"repose chart point takes no file; it charts its own paths"});
  return told(chart_point(common, arguments.file, arguments.quick), common);
}

}  // namespace

io::ExitCode told(const ChartEnd& end, const CommonOptions& options) {
  if (end.kept && !options.quiet && !options.json)
    fmt::print("finished already from the same input; without --resume it is made again\n");
  return end.code;
}

bool drawn(const report::Figure& figure, const std::filesystem::path& file) {
  std::string reason;
  try {
    figure.render_svg(file);
    return true;
  } catch (const report::PlotError& error) {
    reason = error.what();
  } catch (const std::logic_error& error) {  // nothing to draw
    reason = error.what();
  }
  fmt::print(stderr, "warning: no {}: {}\n", file.filename().string(), reason);
  return false;
}

bool drawn(const std::function<report::Figure()>& figure, const std::filesystem::path& file) {
  try {
    return drawn(figure(), file);
  } catch (const std::logic_error& error) {
    fmt::print(stderr, "warning: no {}: {}\n", file.filename().string(), error.what());
    return false;
  }
}

Command add_chart(CLI::App& root) {
  Verb verb(root, "chart", "Speed against accuracy");
  verb.footer(
      "Examples:\n"
      "  repose chart point          integrators of the point driver: error against time\n"
      "  repose chart fit            optimisers: objective against trials and time\n"
      "  repose chart fit FIT.toml   the same on a fit of your own\n"
      "  repose chart mpm            transfers and steps: does the run-out depend on the step?\n"
      "  repose chart mpm SCENE.toml --transfers apic,relaxed --cells 0.0125 --courants 0.4,0.1\n"
      "  repose chart FILE.toml      what the file's [chart] table says, or every [[chart]] of "
      "it;\n"
      "                              every chart leaves such a file, input.toml, beside its "
      "results\n"
      "  repose chart all            every chart and one page of them all, in results/gallery\n"
      "  repose chart all --resume   the same without repeating what is done\n"
      "Writes chart.csv and chart.svg to results/chart_WHAT, and beside them error_map.csv and\n"
      "error_map.svg (point), table.csv (fit) or history.csv, history.svg and cost.svg (mpm).");
  const auto arguments = std::make_shared<ChartArguments>();
  CommonOptions& options = arguments->common;
  verb.required("WHAT", arguments->what, "point, fit, mpm, all, or a file with a [chart] table",
                "TEXT");
  verb.option("FILE", arguments->file,
              "fit: a fit file (default: a twin experiment); mpm: a scene or the name of a "
              "shipped one (default: flat_mu_i)",
              "TEXT");
  verb.option("-o,--output", options.output,
              "Result folder (default: results/chart_WHAT, or results/gallery)", "DIR");
  verb.integer("--evaluations", arguments->evaluations, 1L, 10000000L,
               "fit: most trials of one algorithm (default: 2000)", "N");
  verb.count("--seed", options.seed, "fit: seed of the random algorithms", "N");
  for (std::size_t i = 0; i < list_options.size(); ++i)
    verb.option(fmt::format("--{}", list_options[i].name), arguments->lists[i],
                fmt::format("mpm: {}", list_options[i].doc), "A,B,...");
  verb.flag("--quick", arguments->quick, "Coarse and few: each chart in seconds");
  verb.integer("--threads", options.threads, 0, 4096,
               "mpm: threads of each run (default: 1, so that seconds are those of one core)", "N");
  verb.flag("--resume", options.resume,
            "Keep charts that are finished from the same input; mpm: go on with an interrupted "
            "run from its checkpoint (finished runs are never repeated)");
  add_set(verb, options);
  add_quiet(verb, options);
  add_no_plot(verb, options);
  return {verb.app(), std::shared_ptr<const CommonOptions>(arguments, &arguments->common),
          [arguments] { return run_chart(*arguments); }};
}

}  // namespace repose::app
