#pragma once

namespace repose::app {

/// Parses the command line, runs the verb and turns what it throws into messages on the standard
/// error output and one of the exit codes of ExitCode.
int run_command_line(int argc, const char* const* argv);

}  // namespace repose::app
