#include "app/commands/chart.hpp"

namespace repose::app {

Command add_chart(CLI::App& root) {
  CLI::App* verb = root.add_subcommand("chart", "Speed against accuracy");
  verb->footer(
      "Examples:\n"
      "  repose chart point        integrators of the point driver: error against time\n"
      "Writes chart.csv, chart.svg, error_map.csv and error_map.svg to results/chart_point.");
  const auto options = std::make_shared<CommonOptions>();
  const auto what = std::make_shared<std::string>();
  verb->add_option("WHAT", *what, "point")->required()->check(CLI::IsMember({"point"}));
  verb->add_option("-o,--output", options->output, "Result folder (default: results/chart_WHAT)")
      ->type_name("DIR");
  add_quiet(*verb, *options);
  return {verb, options, [options, what] { return chart_point(*options); }};
}

}  // namespace repose::app
