#pragma once

#include <string>
#include <string_view>

namespace repose::io {

/// A short name for a text that may be long: FNV-1a, 64 bit, as 16 hexadecimal digits. Texts that
/// differ may share it; where that matters, the text itself is kept and compared.
std::string fingerprint_of(std::string_view text);

}  // namespace repose::io
