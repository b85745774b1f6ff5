#include "io/thin_evenly.hpp"

#include <algorithm>

namespace repose::io {

std::vector<std::size_t> thin_evenly(std::size_t count, std::size_t most) {
  std::vector<std::size_t> chosen(std::min(count, most));
  const std::size_t last = chosen.empty() ? 0 : chosen.size() - 1;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    chosen[i] = last == 0 ? 0 : (i * (count - 1) + last / 2) / last;
  return chosen;
}

}  // namespace repose::io
