#pragma once

#include <cstddef>
#include <vector>

namespace repose::io {

/// Indices of at most `most` of `count` things, evenly chosen, the first and the last among them.
std::vector<std::size_t> thin_evenly(std::size_t count, std::size_t most);

}  // namespace repose::io
