#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace repose::report {

struct WrittenReport {
  std::size_t results, bytes;
};

/// One HTML page of result folders (read_result.hpp), in their order; a folder that is named twice
/// counts once. title empty: made of their names. Errors: those of read_result(); IoError.
WrittenReport write_report(const std::vector<std::filesystem::path>& folders,
                           const std::filesystem::path& page, const std::string& title = "");

}  // namespace repose::report
