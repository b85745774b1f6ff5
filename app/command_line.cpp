#include "app/command_line.hpp"

#include <algorithm>
#include <cstdio>
#include <new>
#include <span>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/commands/command.hpp"
#include "input/input_file.hpp"
#include "io/atomic_file.hpp"
#include "io/json.hpp"
#include "repose_version.hpp"

namespace repose::app {
namespace {

constexpr const char* overview =
    "Granular and soil mechanics: drive a law at a point, fit it, run it in a collapse.";

constexpr const char* examples =
    "Examples:\n"
    "  repose check data/scenes/flat_mu_i.toml      what the run will take\n"
    "  repose run data/scenes/flat_mu_i.toml        run it; the result goes to results/flat_mu_i\n"
    "  repose models mu_i                           the parameters of a law\n"
    "\n"
    "Exit codes: 0 done, 2 bad input, 3 numerical failure (state saved), 4 files, 130 "
    "interrupted.\n"
    "`repose VERB --help` tells about one verb.";

/// To the standard error output if that takes it: where it does not (a log on a full disk), the
/// exit code still has to say what happened. (fmt::print throws.)
void say_error(const std::string& line) noexcept {
  std::fwrite(line.data(), 1, line.size(), stderr);
}

/// All complaints go here, one per line, and with --json to the standard output as well.
io::ExitCode complain(io::ExitCode code, const std::vector<std::string>& messages, bool json) {
  for (const std::string& message : messages) say_error(message + "\n");
  if (json) {
    const std::string line =
        io::Json{{"event", "error"}, {"messages", messages}, {"exit", static_cast<int>(code)}}
            .dump() +
        "\n";
    std::fwrite(line.data(), 1, line.size(), stdout);
  }
  return code;
}

io::ExitCode run(const Command& command) {
  const bool json = command.options->json;
  try {
    return command.run();
  } catch (const input::BadInput& error) {
    return complain(io::ExitCode::bad_input, error.problems(), json);
  } catch (const io::IoError& error) {
    return complain(io::ExitCode::io_error, {error.what()}, json);
  } catch (const std::bad_alloc&) {
    return complain(
        io::ExitCode::bad_input,
        {"repose: not enough memory; a larger grid.h or fewer points_per_cell need less"}, json);
  } catch (const std::exception& error) {
    return complain(io::ExitCode::internal_error,
                    {fmt::format("repose {}: internal error: {}", version_string, error.what())},
                    json);
  }
}

/// A verb or option that nearly was one.
std::string suggestion(std::string_view word, const CLI::App& root, const CLI::App* verb) {
  std::vector<std::string> known;
  if (word.starts_with("-")) {
    for (const CLI::App* app : {&root, verb})
      if (app != nullptr)
        for (const CLI::Option* option : app->get_options())
          for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    word = word.substr(0, word.find('='));
  } else {
    for (const CLI::App* app : root.get_subcommands(nullptr)) known.push_back(app->get_name());
  }
  const std::vector<std::string_view> views(known.begin(), known.end());
  const std::string near = input::closest(word, views);
  return near.empty() ? "" : fmt::format("; did you mean '{}'?", near);
}

io::ExitCode misuse(const std::string& message, const CLI::App* verb) {
  say_error(fmt::format("repose: {}\n`repose {}--help` shows how it goes.\n", message,
                        verb == nullptr ? "" : verb->get_name() + " "));
  return io::ExitCode::bad_input;
}

std::vector<Command> add_commands(CLI::App& root) {
  return {add_run(root),    add_check(root),  add_models(root),      add_point(root),
          add_chart(root),  add_fit(root),    add_stability(root),   add_validate(root),
          add_report(root), add_schema(root), add_sensitivity(root), add_propagate(root)};
}

io::ExitCode parse_and_run(std::span<const char* const> arguments) {
  CLI::App root(overview, "repose");
  root.set_help_flag("-h,--help", "Show this and exit");
  root.set_version_flag("--version", std::string("repose ") + version_string);
  std::string set;  // taken out of the arguments before they are parsed (other_sets.hpp)
  root.add_option(
          "--instruction-set", set,
          "Before the verb: avx512 or avx2, where both are installed (on ARM there is neon); "
          "default: the fastest that the machine has")
      ->type_name("SET");
  root.require_subcommand(1);
  root.footer(examples);
  root.get_formatter()->column_width(32);
  const std::vector<Command> commands = add_commands(root);

  if (arguments.size() < 2) {
    fmt::print(stderr, "{}", root.help());
    return io::ExitCode::bad_input;
  }
  const std::string_view first = arguments[1];
  const auto is_first = [&](const Command& c) { return c.verb->get_name() == first; };
  if (!first.starts_with("-") && std::none_of(commands.begin(), commands.end(), is_first))
    return misuse(fmt::format("there is no verb '{}'{}", first, suggestion(first, root, nullptr)),
                  nullptr);
  try {
    root.parse(static_cast<int>(arguments.size()), arguments.data());
  } catch (const CLI::CallForVersion& version) {
    fmt::print("{}\n", version.what());
    return io::ExitCode::done;
  } catch (const CLI::CallForHelp&) {
    const auto chosen = root.get_subcommands();
    fmt::print("{}", chosen.empty() ? root.help() : chosen.front()->help("repose"));
    return io::ExitCode::done;
  } catch (const CLI::ParseError& error) {
    const auto chosen = root.get_subcommands();
    const CLI::App* verb = chosen.empty() ? nullptr : chosen.front();
    const std::vector<std::string> extras = root.remaining(true);
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !extras.empty())
      return misuse(fmt::format("'{}' was not expected{}", extras.front(),
                                suggestion(extras.front(), root, verb)),
                    verb);
    return misuse(error.what(), verb);
  }
  for (const Command& command : commands)
    if (command.verb->parsed()) return run(command);
  return io::ExitCode::bad_input;
}

}  // namespace

std::string origin_line(const std::string& path, const CommonOptions& options) {
  std::string text = "From " + path;
  for (std::size_t i = 0; i < options.sets.size(); ++i)
    text += fmt::format("{} --set {}", i == 0 ? " with" : "", options.sets[i]);
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return text;
}

Verb::Verb(CLI::App& root, const std::string& name, const std::string& doc)
    : app_(root.add_subcommand(name, doc)) {}

void Verb::footer(const std::string& text) { app_->footer(text); }

void Verb::option(const std::string& name, std::string& value, const std::string& doc,
                  const std::string& type) {
  app_->add_option(name, value, doc)->type_name(type);
}

void Verb::required(const std::string& name, std::string& value, const std::string& doc,
                    const std::string& type) {
  app_->add_option(name, value, doc)->type_name(type)->required();
}

void Verb::option(const std::string& name, std::optional<double>& value, const std::string& doc,
                  const std::string& type) {
  app_->add_option(name, value, doc)->type_name(type);
}

void Verb::option(const std::string& name, std::vector<std::string>& values, const std::string& doc,
                  const std::string& type) {
  app_->add_option(name, values, doc)->type_name(type);
}

void Verb::required(const std::string& name, std::vector<std::string>& values,
                    const std::string& doc, const std::string& type) {
  app_->add_option(name, values, doc)->type_name(type)->required();
}

void Verb::repeated(const std::string& name, std::vector<std::string>& values,
                    const std::string& doc, const std::string& type) {
  app_->add_option(name, values, doc)->type_name(type)->allow_extra_args(false);
}

void Verb::integer(const std::string& name, int& value, int lower, int upper,
                   const std::string& doc, const std::string& type) {
  app_->add_option(name, value, doc)
      ->type_name(type)
      ->check(CLI::Range(lower, upper).description(""));
}

void Verb::integer(const std::string& name, std::optional<long>& value, long lower, long upper,
                   const std::string& doc, const std::string& type) {
  app_->add_option(name, value, doc)
      ->type_name(type)
      ->check(CLI::Range(lower, upper).description(""));
}

void Verb::count(const std::string& name, std::uint64_t& value, const std::string& doc,
                 const std::string& type) {
  app_->add_option(name, value, doc)
      ->type_name(type)
      ->check(CLI::NonNegativeNumber.description(""));
}

void Verb::flag(const std::string& name, bool& value, const std::string& doc) {
  app_->add_flag(name, value, doc);
}

void add_set(Verb& verb, CommonOptions& options) {
  verb.repeated("--set", options.sets,
                "Override a key of the file, as in --set grid.h=0.0125 or "
                "--set body[0].law.K=26e3; may be repeated",
                "KEY=VALUE");
}

void add_threads(Verb& verb, CommonOptions& options) {
  verb.integer("--threads", options.threads, 0, 4096, "Threads to use (default: one per core)",
               "N");
}

void add_quiet(Verb& verb, CommonOptions& options) {
  verb.flag("--quiet", options.quiet, "Print nothing but errors");
  verb.flag("--json", options.json, "Print JSON instead of text");
}

void add_no_plot(Verb& verb, CommonOptions& options) {
  verb.flag("--no-plot", options.no_plot, "Draw no picture");
}

void add_run_options(Verb& verb, CommonOptions& options) {
  verb.option("-o,--output", options.output, "Result folder (default: results/NAME)", "DIR");
  add_set(verb, options);
  add_threads(verb, options);
  verb.count("--seed", options.seed, "Seed of random numbers, recorded with the result", "N");
  verb.flag("--resume", options.resume, "Continue from the checkpoint in the result folder");
  add_no_plot(verb, options);
  add_quiet(verb, options);
}

io::ExitCode run_verb(std::span<const std::string> arguments) {
  CLI::App root(overview, "repose");
  root.require_subcommand(1);
  const std::vector<Command> commands = add_commands(root);
  try {
    // CLI11 takes them from the last to the first
    root.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::ParseError& error) {
    throw input::BadInput({error.what()});
  }
  for (const Command& command : commands)
    if (command.verb->parsed()) return command.run();
  return io::ExitCode::bad_input;
}

int run_command_line(int argc, const char* const* argv) {
  try {
    return static_cast<int>(parse_and_run({argv, static_cast<std::size_t>(argc)}));
  } catch (const std::exception& error) {
    say_error(fmt::format("repose {}: internal error: {}\n", version_string, error.what()));
    return static_cast<int>(io::ExitCode::internal_error);
  }
}

}  // namespace repose::app
