#include "app/commands/command.hpp"
#include "input/law_tables.hpp"

namespace repose::app {

Command add_models(CLI::App& root) {
  Verb verb(root, "models", "The laws, or the parameters of one law");
  verb.footer("Examples:\n  repose models\n  repose models mu_i");
  const auto options = std::make_shared<CommonOptions>();
  const auto name = std::make_shared<std::string>();
  verb.option("LAW", *name, "Name of a law", "");
  verb.flag("--json", options->json, "Print JSON instead of text");
  return {verb.app(), options, [options, name] {
            const std::string text = options->json   ? input::laws_as_json(*name)
                                     : name->empty() ? input::law_list()
                                                     : input::law_description(*name);
            std::fputs(text.c_str(), stdout);
            return io::ExitCode::done;
          }};
}

}  // namespace repose::app
