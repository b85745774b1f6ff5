#pragma once
/// \file
/// What a point test leaves in words and figures: its input with defaults, and summary.json.

#include <toml++/toml.h>

#include "io/json.hpp"
#include "study/point/test_result.hpp"

namespace repose::study {

/// The input of a test with the defaults that its numbers depend on, and a measured history by its
/// absolute path.
toml::table resolved_test(const input::InputFile& input, const input::PointTestFile& file);

/// summary.json. input: resolved_test(); cpu_s: of driving; seed: recorded. Values that are not
/// finite become null.
io::Json test_summary(const input::PointTestFile& file, const TestResult& result,
                      const toml::table& input, double cpu_s, std::uint64_t seed);

}  // namespace repose::study
