#include "app/commands/command.hpp"
#include "input/input_file.hpp"
#include "input/law_tables.hpp"
#include "umat/out/tables.hpp"

namespace repose::app {

Command add_models(CLI::App& root) {
  Verb verb(root, "models", "The laws, or the parameters of one law");
  verb.footer("Examples:\n  repose models\n  repose models mu_i\n  repose models --umat");
  const auto options = std::make_shared<CommonOptions>();
  const auto name = std::make_shared<std::string>();
  verb.option("LAW", *name, "Name of a law", "");
  verb.flag("--json", options->json, "Print JSON instead of text");
  const auto umat = std::make_shared<bool>(false);
  verb.flag("--umat", *umat,
            "Print names, constants and state variables of the UMAT (docs/umat_out.md)");
  return {verb.app(), options, [options, name, umat] {
            if (*umat && options->json)
              throw input::BadInput(
                  {"repose models: --umat prints a page's text, and --json another: give one"});
            // (a law that is unknown is refused here)
            const std::string described =
                name->empty() ? input::law_list() : input::law_description(*name);
            const std::string text = *umat           ? umat::tables(*name)
                                     : options->json ? input::laws_as_json(*name)
                                                     : described;
            std::fputs(text.c_str(), stdout);
            return io::ExitCode::done;
          }};
}

}  // namespace repose::app
