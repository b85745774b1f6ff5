#pragma once

#include <span>
#include <string>
#include <string_view>

#include "io/json.hpp"

namespace repose::report {

/// The page as one HTML text that needs nothing else: style, program and data inside.
/// results: of read_result(). The same results give the same text. Whatever a result holds reaches
/// the page as text, never as markup: in the data every '<' is written \u003c, so that nothing ends
/// the element early, and the program sets text nodes only. Bytes that are no UTF-8 become U+FFFD.
std::string report_page(std::span<const io::Json> results, std::string_view title);

/// &, <, > and both quotes as entities: for text and for attributes.
std::string html_text(std::string_view text);

/// JSON that may stand inside a script element.
std::string script_json(const io::Json& data);

}  // namespace repose::report
