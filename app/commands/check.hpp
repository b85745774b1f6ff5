#pragma once
/// \file
/// `repose check`, also for those who throw files at it (tests/fuzz).

#include "app/commands/command.hpp"

namespace repose::app {

enum class Looks : std::uint8_t {
  measure,  ///< a scene takes some steps, from which its time follows
  count,    ///< nothing is laid out: what a scene takes is counted from its numbers
};

/// Reads a file of any kind, validates it and prints what running it will take. picture: a file
/// that a scene is drawn into; empty: none is.
/// Errors: BadInput and IoError for a file that cannot be used.
io::ExitCode check_file(const std::string& path, const CommonOptions& options,
                        Looks looks = Looks::measure, const std::string& picture = {});

}  // namespace repose::app
