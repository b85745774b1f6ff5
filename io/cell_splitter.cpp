#include "io/cell_splitter.hpp"

#include <algorithm>
#include <optional>

#include "io/number_text.hpp"

namespace repose::io {
namespace {

constexpr int most_lines_in_quotes = 20;

char character_of(Separator separator) {
  switch (separator) {
    case Separator::comma:
      return ',';
    case Separator::semicolon:
      return ';';
    case Separator::tab:
      return '\t';
    default:
      return 0;
  }
}

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::size_t line_end(std::string_view text, std::size_t from) {
  return std::min(text.find_first_of("\r\n", from), text.size());
}

/// After the line break at `at`.
std::size_t next_line(std::string_view text, std::size_t at) {
  if (at < text.size() && text[at] == '\r' && at + 1 < text.size() && text[at + 1] == '\n') ++at;
  return std::min(at + 1, text.size());
}

/// "#N/A" and its like are cells of a spreadsheet program.
bool starts_comment(std::string_view line) {
  line = trimmed(line);
  if (line.starts_with("#N/A") || line.starts_with("#DIV/0!") || line.starts_with("#VALUE!") ||
      line.starts_with("#REF!") || line.starts_with("#NAME?") || line.starts_with("#NUM!"))
    return false;
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//");
}

class Splitter {
 public:
  Splitter(std::string_view text, Separator separator)
      : text_(text),
        separator_(separator),
        mark_(character_of(separator)) {}

  CellList split() {
    std::size_t at = 0;
    int row = 1;
    while (at < text_.size()) {
      const std::size_t end = line_end(text_, at);
      const std::string_view line = text_.substr(at, end - at);
      Record record;
      record.row = row;
      record.begin = list_.cells.size();
      record.comment = starts_comment(line);
      std::size_t stop = end;
      if (!trimmed(line).empty()) stop = cells_from(at, record);
      record.count = list_.cells.size() - record.begin;
      record.line = text_.substr(at, stop - at);
      const bool some = std::any_of(list_.cells.begin() + static_cast<std::ptrdiff_t>(record.begin),
                                    list_.cells.end(), [](auto cell) { return !cell.empty(); });
      if (some)
        list_.records.push_back(record);
      else
        list_.cells.resize(record.begin);
      row += 1 + breaks_;
      breaks_ = 0;
      at = next_line(text_, stop);
    }
    return std::move(list_);
  }

 private:
  /// Appends the cells of a record; returns where its last line ends.
  std::size_t cells_from(std::size_t at, const Record& record) {
    for (;;) {
      at = skip_padding(at);
      if (separator_ == Separator::blanks && ends_line(at)) return at;
      if (at < text_.size() && text_[at] == '"' && !record.comment) {
        if (const auto after = quoted_cell(at, record)) {
          at = *after;
          if (ends_line(at)) return at;
          at += separator_ == Separator::blanks ? 0 : 1;
          continue;
        }
      }
      const std::size_t end = cell_end(at);
      list_.cells.push_back(trimmed(text_.substr(at, end - at)));
      if (ends_line(end)) return end;
      at = end + 1;
    }
  }

  bool ends_line(std::size_t at) const {
    return at >= text_.size() || text_[at] == '\r' || text_[at] == '\n';
  }

  /// Blanks before a cell; a tab that separates is none.
  std::size_t skip_padding(std::size_t at) const {
    while (at < text_.size() && is_blank(text_[at]) && text_[at] != mark_) ++at;
    return at;
  }

  std::size_t cell_end(std::size_t at) const {
    while (!ends_line(at)) {
      if (mark_ != 0 && text_[at] == mark_) break;
      if (separator_ == Separator::blanks && is_blank(text_[at])) break;
      ++at;
    }
    return at;
  }

  /// A cell in quotes; returns where the separator or the line's end after it stands. None, and no
  /// cell, if it is no such cell.
  std::optional<std::size_t> quoted_cell(std::size_t open, const Record& record) {
    bool doubled = false;
    int breaks = 0;
    std::size_t i = open + 1;
    for (;; ++i) {
      if (i >= text_.size() || breaks > most_lines_in_quotes) {
        if (list_.open_quote_row == 0) {
          list_.open_quote_row = record.row + breaks_;
          list_.open_quote_cell = list_.cells.size() - record.begin;
        }
        return {};
      }
      if (text_[i] == '\r' || text_[i] == '\n') {
        i = next_line(text_, i) - 1;
        ++breaks;
      }
      if (text_[i] != '"') continue;
      if (i + 1 >= text_.size() || text_[i + 1] != '"') break;
      doubled = true;
      ++i;
    }
    std::size_t after = i + 1;
    const std::size_t next = skip_padding(after);
    if (separator_ == Separator::blanks ? next == after && !ends_line(after)
                                        : !ends_line(next) && text_[next] != mark_)
      return {};
    std::string_view inside = text_.substr(open + 1, i - open - 1);
    if (doubled) {
      std::string plain;
      plain.reserve(inside.size());
      for (std::size_t k = 0; k < inside.size(); ++k) {
        plain += inside[k];
        if (inside[k] == '"') ++k;
      }
      list_.rewritten.push_back(std::make_unique<const std::string>(std::move(plain)));
      inside = *list_.rewritten.back();
    }
    list_.cells.push_back(trimmed(inside));
    breaks_ += breaks;
    return next;
  }

  std::string_view text_;
  Separator separator_;
  char mark_;
  CellList list_;
  int breaks_ = 0;  ///< line breaks inside cells of the present record
};

}  // namespace

std::string_view name_of(Separator separator) {
  switch (separator) {
    case Separator::detect:
      return "to be detected";
    case Separator::comma:
      return "comma";
    case Separator::semicolon:
      return "semicolon";
    case Separator::tab:
      return "tab";
    case Separator::blanks:
      return "blanks";
    case Separator::none:
      return "none (one column)";
  }
  return "";
}

CellList split_cells(std::string_view text, Separator separator) {
  return Splitter(text, separator).split();
}

std::vector<std::string_view> split_padded(std::string_view line) {
  std::vector<std::string_view> cells;
  std::size_t at = 0;
  while (at < line.size()) {
    std::size_t end = at;
    while (end < line.size() && line[end] != '\t' &&
           !(line[end] == ' ' && (end + 1 == line.size() || is_blank(line[end + 1]))))
      ++end;
    if (end > at) cells.push_back(line.substr(at, end - at));
    at = end;
    while (at < line.size() && is_blank(line[at])) ++at;
  }
  return cells;
}

std::vector<std::string_view> split_blanks(std::string_view line) {
  std::vector<std::string_view> cells;
  std::size_t at = 0;
  for (;;) {
    while (at < line.size() && is_blank(line[at])) ++at;
    if (at == line.size()) return cells;
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    cells.push_back(line.substr(at, end - at));
    at = end;
  }
}

std::string_view comment_text(std::string_view line) {
  line = trimmed(line);
  if (line.starts_with("//")) {
    line.remove_prefix(2);
  } else {
    const char mark = line.empty() ? 0 : line.front();
    while ((mark == '#' || mark == '%') && line.starts_with(mark)) line.remove_prefix(1);
  }
  return trimmed(line);
}

}  // namespace repose::io
