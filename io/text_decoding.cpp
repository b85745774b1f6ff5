#include "io/text_decoding.hpp"

#include <algorithm>
#include <array>

#include <fmt/core.h>

#include "io/table_error.hpp"

namespace repose::io {
namespace {

constexpr std::string_view save_as_text = "save the table as CSV (UTF-8) and give that file";

void append_utf8(std::string& out, char32_t c) {
  const auto put = [&](char32_t bits) {
    out += static_cast<char>(static_cast<unsigned char>(bits));
  };
  if (c < 0x80) {
    put(c);
  } else if (c < 0x800) {
    put(0xC0 | (c >> 6));
    put(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    put(0xE0 | (c >> 12));
    put(0x80 | ((c >> 6) & 0x3F));
    put(0x80 | (c & 0x3F));
  } else {
    put(0xF0 | (c >> 18));
    put(0x80 | ((c >> 12) & 0x3F));
    put(0x80 | ((c >> 6) & 0x3F));
    put(0x80 | (c & 0x3F));
  }
}

/// Length of the UTF-8 character at the start, 0 if there is none (Unicode 15, table 3-7).
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char a = byte(0);
  if (a < 0x80) return 1;
  const std::size_t n = a >= 0xC2 && a < 0xE0   ? 2
                        : a >= 0xE0 && a < 0xF0 ? 3
                        : a >= 0xF0 && a < 0xF5 ? 4
                                                : 0;
  if (n == 0 || text.size() < n) return 0;
  for (std::size_t i = 1; i < n; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const unsigned char b = byte(1);
  const bool overlong = (a == 0xE0 && b < 0xA0) || (a == 0xF0 && b < 0x90);
  const bool outside = (a == 0xED && b >= 0xA0) || (a == 0xF4 && b >= 0x90);
  return overlong || outside ? 0 : n;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t n = utf8_length(text);
    if (n == 0) return false;
    text.remove_prefix(n);
  }
  return true;
}

/// Windows-1252 in 0x80 … 0x9F; 0: not a character.
constexpr std::array<char16_t, 32> windows{
    0x20AC, 0,      0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017D, 0,      0,      0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
    0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0,      0x017E, 0x0178};

int row_at(std::string_view text, std::size_t position) {
  int row = 1;
  for (std::size_t i = 0; i < position; ++i)
    if (text[i] == '\n' || (text[i] == '\r' && !(i + 1 < text.size() && text[i + 1] == '\n')))
      ++row;
  return row;
}

std::string from_windows(std::string_view bytes, const std::string& file) {
  std::string text;
  text.reserve(bytes.size() + bytes.size() / 8);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const auto c = static_cast<unsigned char>(bytes[i]);
    const char32_t u = c >= 0x80 && c < 0xA0 ? windows[c - 0x80u] : c;
    if (u == 0 && c != 0)
      throw TableError(file, row_at(bytes, i), "",
                       fmt::format("byte 0x{:02X} is neither UTF-8 nor Windows-1252 text", c),
                       std::string(save_as_text));
    append_utf8(text, u);
  }
  return text;
}

std::string from_utf16(std::string_view bytes, bool big, const std::string& file) {
  if (bytes.size() % 2 != 0)
    throw TableError(file, 0, "", "UTF-16 text with an odd number of bytes: the file is cut off",
                     std::string(save_as_text));
  const auto unit = [&](std::size_t i) {
    const auto a = static_cast<unsigned char>(bytes[i]),
               b = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<char32_t>(big ? (a << 8) | b : (b << 8) | a);
  };
  std::string text;
  text.reserve(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    char32_t c = unit(i);
    if (c >= 0xD800 && c < 0xE000) {
      const char32_t low = c < 0xDC00 && i + 2 < bytes.size() ? unit(i + 2) : 0;
      if (low < 0xDC00 || low >= 0xE000)
        throw TableError(file, row_at(text, text.size()), "", "UTF-16 text with half a character",
                         std::string(save_as_text));
      c = 0x10000 + ((c - 0xD800) << 10) + (low - 0xDC00);
      i += 2;
    }
    append_utf8(text, c);
  }
  return text;
}

/// What the first bytes say if the file is no text at all.
std::string_view foreign_kind(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.starts_with("PK\x03\x04"sv)) return "a workbook (xlsx, ods) or another zip archive";
  if (bytes.starts_with("\xD0\xCF\x11\xE0"sv)) return "an old Excel workbook (xls)";
  if (bytes.starts_with("%PDF-"sv)) return "a PDF document";
  if (bytes.starts_with("\x1F\x8B"sv)) return "compressed by gzip";
  if (bytes.starts_with("\x89HDF"sv)) return "an HDF5 file";
  if (bytes.starts_with("\xFF\xFE\0\0"sv) || bytes.starts_with("\0\0\xFE\xFF"sv))
    return "UTF-32 text, which is not read";
  return {};
}

void refuse_control_characters(std::string& text, const std::string& file) {
  if (text.ends_with('\x1A')) text.pop_back();  // DOS ended its files so
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c == '\f' || c == '\v') text[i] = ' ';
    if (c >= 0x20 || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v') continue;
    throw TableError(file, row_at(text, i), "",
                     fmt::format("{} (0x{:02X}): this is not text",
                                 c == 0 ? "a NUL byte" : "a control character", c),
                     std::string(save_as_text));
  }
}

}  // namespace

std::string_view name_of(Encoding encoding) {
  switch (encoding) {
    case Encoding::utf8:
      return "UTF-8";
    case Encoding::utf8_mark:
      return "UTF-8 with byte-order mark";
    case Encoding::utf16_le:
      return "UTF-16 (little end first)";
    case Encoding::utf16_be:
      return "UTF-16 (big end first)";
    case Encoding::windows_1252:
      return "Windows-1252";
  }
  return "";
}

DecodedText decode_text(std::string bytes, const std::string& file) {
  using namespace std::string_view_literals;
  if (const std::string_view kind = foreign_kind(bytes); !kind.empty())
    throw TableError(file, 0, "", fmt::format("this is {}", kind), std::string(save_as_text));
  const auto zero = [&](std::size_t i) { return i < bytes.size() && bytes[i] == 0; };
  const std::string_view all(bytes);
  DecodedText result;
  if (all.starts_with("\xEF\xBB\xBF"sv)) {
    result = {is_utf8(all) ? bytes.substr(3) : from_windows(all.substr(3), file),
              Encoding::utf8_mark};
  } else if (all.starts_with("\xFF\xFE"sv)) {
    result = {from_utf16(all.substr(2), false, file), Encoding::utf16_le};
  } else if (all.starts_with("\xFE\xFF"sv)) {
    result = {from_utf16(all.substr(2), true, file), Encoding::utf16_be};
  } else if (all.size() >= 4 && !zero(0) && zero(1) && !zero(2) && zero(3)) {
    result = {from_utf16(all, false, file), Encoding::utf16_le};
  } else if (all.size() >= 4 && zero(0) && !zero(1) && zero(2) && !zero(3)) {
    result = {from_utf16(all, true, file), Encoding::utf16_be};
  } else if (is_utf8(all)) {
    result = {std::move(bytes), Encoding::utf8};
  } else {
    result = {from_windows(all, file), Encoding::windows_1252};
  }
  refuse_control_characters(result.text, file);
  return result;
}

}  // namespace repose::io
