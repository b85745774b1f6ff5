#pragma once

#include <span>
#include <string>

#include "io/exit_code.hpp"

namespace repose::app {

/// Parses the command line, runs the verb and turns what it throws into messages on the standard
/// error output and one of the exit codes of ExitCode.
int run_command_line(int argc, const char* const* argv);

/// The same of one verb for a program that catches what it throws: BadInput (of a command line that
/// is none as well), IoError, InputError. arguments: the verb first.
io::ExitCode run_verb(std::span<const std::string> arguments);

}  // namespace repose::app
