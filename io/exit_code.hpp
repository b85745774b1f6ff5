#pragma once

namespace repose::io {

/// What the command returns to the shell.
enum class ExitCode : int {
  done = 0,
  internal_error = 1,     ///< a defect of repose itself
  bad_input = 2,          ///< the input file, --set or the command line
  numerical_failure = 3,  ///< the state before it is saved
  io_error = 4,
  interrupted = 130,  ///< a checkpoint is saved
};

}  // namespace repose::io
