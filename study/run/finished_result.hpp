#pragma once

#include <string_view>

#include "io/result_folder.hpp"

namespace repose::study {

/// Did the work on this very input text come to its end in the folder? The text itself is compared,
/// not a hash of it, and it names the version of repose.
bool is_finished(const io::ResultFolder& folder, std::string_view input);

/// A file as text; "" if it cannot be read.
std::string text_of(const std::filesystem::path& file);

}  // namespace repose::study
