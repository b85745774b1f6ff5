#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/result_folder.hpp"

namespace repose::study {

/// Did the work on this very input text come to its end in the folder? The text itself is compared,
/// not a hash of it, and it names the version of repose. A result whose files are not as they were
/// written is none, and the standard error output says so.
bool is_finished(const io::ResultFolder& folder, std::string_view input);

/// Removes what a kill between the seal of a result and the end of its process has left: the lock
/// and the checkpoints. Errors: IoError if another process has the folder.
void tidy_finished(const io::ResultFolder& folder);

/// A file as text; "" if it cannot be read.
std::string text_of(const std::filesystem::path& file);

/// What summary.json says of a run.
struct RunSummary {
  std::string status;  ///< "": no result yet
  std::string reason;  ///< of a failure
  std::vector<std::string> warnings;
  std::map<std::string, double, std::less<>> figures;  ///< every number of it
};

/// Errors: IoError if it is not there or no summary.
RunSummary read_summary(const std::filesystem::path& file);

/// The columns of a table of numbers that this program has written.
using NumberTable = std::map<std::string, std::vector<double>, std::less<>>;
/// Errors: IoError if it cannot be read or a row is too short or holds anything else.
NumberTable read_numbers(const std::filesystem::path& file);

}  // namespace repose::study
