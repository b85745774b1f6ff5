#include "app/commands/chart.hpp"

#include "app/input_file.hpp"

namespace repose::app {

Command add_chart(CLI::App& root) {
  CLI::App* verb = root.add_subcommand("chart", "Speed against accuracy");
  verb->footer(
      "Examples:\n"
      "  repose chart point          integrators of the point driver: error against time\n"
      "  repose chart fit            optimisers: objective against trials and time\n"
      "  repose chart fit FIT.toml   the same on a fit of your own\n"
      "Writes chart.csv and chart.svg to results/chart_WHAT, and beside them error_map.csv and\n"
      "error_map.svg (point) or table.csv (fit).");
  const auto options = std::make_shared<CommonOptions>();
  const auto what = std::make_shared<std::string>();
  const auto file = std::make_shared<std::string>();
  const auto evaluations = std::make_shared<long>(2000);
  verb->add_option("WHAT", *what, "point or fit")
      ->required()
      ->check(CLI::IsMember({"point", "fit"}));
  verb->add_option("FILE", *file, "A fit file (fit only; default: a twin experiment)");
  verb->add_option("-o,--output", options->output, "Result folder (default: results/chart_WHAT)")
      ->type_name("DIR");
  verb->add_option("--evaluations", *evaluations, "Most trials of one algorithm (fit only)")
      ->check(CLI::Range(1L, 10000000L).description(""))
      ->type_name("N")
      ->capture_default_str();
  verb->add_option("--seed", options->seed, "Seed of the random algorithms (fit only)")
      ->check(CLI::NonNegativeNumber.description(""))
      ->type_name("N");
  add_set(*verb, *options);
  add_quiet(*verb, *options);
  return {verb, options, [options, what, file, evaluations] {
            if (file->empty() && !options->sets.empty())
              throw BadInput({"--set changes the keys of a fit file: repose chart fit FIT.toml"});
            if (*what == "fit") return chart_fit(*options, *file, *evaluations);
            if (!file->empty())
              throw BadInput({"repose chart point takes no file; it charts its own six paths"});
            return chart_point(*options);
          }};
}

}  // namespace repose::app
