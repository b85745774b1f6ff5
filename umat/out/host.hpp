#pragma once
/// \file
/// The program that calls: where it takes messages, and how it is stopped.

#include <string>

namespace repose::umat {

/// Says what is wrong and stops the analysis:
///   with the host's STDB_ABQERR, an error message in its message file that stops at once (LOP =
///   -3); else on standard error;
///   then by the host's XIT; where it has neither, by std::exit(2).
/// Returns where XIT does.
void stop(const std::string& message);

}  // namespace repose::umat
