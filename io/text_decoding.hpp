#pragma once
/// \file
/// Bytes of a text file become UTF-8.

#include <cstdint>
#include <string>
#include <string_view>

namespace repose::io {

enum class Encoding : std::uint8_t { utf8, utf8_mark, utf16_le, utf16_be, windows_1252 };

/// "UTF-8", "UTF-8 with byte-order mark", "UTF-16 (little end first)", ...
std::string_view name_of(Encoding encoding);

struct DecodedText {
  std::string text;  ///< UTF-8 without byte-order mark
  Encoding encoding = Encoding::utf8;
};

/// UTF-8 and UTF-16 with or without a byte-order mark; what is not UTF-8 counts as Windows-1252 (of
/// which Latin-1 text is a part). UTF-16 without a mark is told by its first two characters.
/// Throws TableError for workbooks, PDF and archives (told by their first bytes), UTF-32, broken
/// UTF-16, NUL bytes and other control characters, with the row.
DecodedText decode_text(std::string bytes, const std::string& file);

}  // namespace repose::io
