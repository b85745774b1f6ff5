#pragma once
/// \file
/// The word that a misspelt one may stand for.

#include <string>
#include <string_view>
#include <vector>

namespace repose::io {

/// The known words closest to a misspelt one, best first, at most three: edit distance without
/// regard to letter case, at most a third of the letters (but one at least) wrong, or the misspelt
/// word a part of the known one. Nothing is close to a single letter.
std::vector<std::string> nearest_texts(std::string_view misspelt,
                                       const std::vector<std::string>& known);

/// "did you mean \"q\" or \"p\"?"; "" if nothing is close.
std::string did_you_mean(std::string_view misspelt, const std::vector<std::string>& known);

}  // namespace repose::io
