#pragma once

#include <filesystem>

#include "io/json.hpp"

namespace repose::report {

/// Everything that the page shows of one result folder:
///     {"path", "label", "kind", "summary": {…}, "input": "input.toml's text",
///      "tables": {"series.csv": csv_columns()}, "pictures": [{"name", "svg"}],
///      "texts": [{"name": "fitted.toml", "text"}], "fit": fit.json, "frames": pack_frames(),
///      "notes": ["what was left out, and why"]}
/// kind: as summary.json says; a summary without one is that of a run. Parts that the folder does
/// not have are absent.
/// Errors: BadInput where the folder is no result folder; IoError for what cannot be read.
io::Json read_result(const std::filesystem::path& folder);

}  // namespace repose::report
