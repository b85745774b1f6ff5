#pragma once

#include <chrono>
#include <stdexcept>
#include <string>
#include <string_view>

namespace repose::report {

/// gnuplot could not be started or refused its script. A picture is never worth a run: callers
/// warn.
class PlotError : public std::runtime_error {
 public:
  explicit PlotError(const std::string& message, std::string messages_of_gnuplot = {})
      : std::runtime_error(message),
        gnuplot_messages_(std::move(messages_of_gnuplot)) {}

  /// What gnuplot wrote to its standard error; empty if it did not start.
  const std::string& gnuplot_messages() const { return gnuplot_messages_; }

 private:
  std::string gnuplot_messages_;
};

/// Runs the `gnuplot` of the search path on a script, without a shell and without the user's or the
/// system's start-up files, and returns what it wrote to its standard output. Errors: PlotError,
/// also if it is not done within the limit; it is stopped then.
std::string run_gnuplot(std::string_view script,
                        std::chrono::milliseconds limit = std::chrono::seconds(30));

/// A text as a gnuplot string literal for its "enhanced" mode: nothing in it is a command, a
/// variable or markup, except that _{...} is a subscript and ^{...} a superscript. Line breaks and
/// other control characters become spaces, bytes that are not UTF-8 the replacement character.
/// Single-quoted, so that gnuplot runs no `backquoted` command.
std::string gnuplot_text(std::string_view text, bool bold = false);

}  // namespace repose::report
