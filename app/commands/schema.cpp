#include "input/schema.hpp"

#include "app/commands/command.hpp"

namespace repose::app {

Command add_schema(CLI::App& root) {
  Verb verb(root, "schema", "The keys of input files, for editors");
  verb.footer(
      "A first line such as `#:schema scene.json` makes an editor (Taplo, Even Better TOML) "
      "complete\n"
      "and check the file.\n"
      "Examples:\n"
      "  repose schema scene > scene.json\n"
      "  repose schema --page > keys.md       every key of every kind, as a page");
  const auto options = std::make_shared<CommonOptions>();
  const auto kind = std::make_shared<std::string>();
  const auto page = std::make_shared<bool>(false);
  verb.option("KIND", *kind, "scene, test, fit, chart or case", "");
  verb.flag("--page", *page, "Print the reference page of all kinds instead");
  return {verb.app(), options, [kind, page] {
            const std::string text =
                *page ? input::key_page() : input::json_schema(input::schema_kind(*kind));
            std::fputs(text.c_str(), stdout);
            return io::ExitCode::done;
          }};
}

}  // namespace repose::app
