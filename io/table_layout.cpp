#include "io/table_layout.hpp"

#include <algorithm>
#include <map>

#include "io/units.hpp"

namespace repose::io {
namespace {

/// What a record holds, as far as layout is concerned.
struct Content {
  std::size_t width = 0;    ///< cells
  std::size_t trimmed = 0;  ///< without blank ones at the end
  std::size_t numbers = 0;  ///< numbers and nan
  std::size_t blanks = 0;   ///< blank or missing
  std::size_t texts = 0;
  std::size_t numbers_size = 0;
};

constexpr std::size_t most_sparse_rows = 100;  ///< between a header and the first number

bool has_letter(std::string_view cell) {
  return std::any_of(cell.begin(), cell.end(),
                     [](char c) { return (c | 0x20) >= 'a' && (c | 0x20) <= 'z'; });
}

class Judge {
 public:
  Judge(Reading& reading, char decimal) : r_(reading), decimal_(decimal) {
    contents_.reserve(list().records.size());
    for (const Record& record : list().records) contents_.push_back(content_of(record));
  }

  void judge(std::optional<int> header_row) {
    r_.width = usual_width();
    if (header_row && *header_row > 0)
      take_header_at(*header_row);
    else if (!header_row && r_.width > 0)
      find_header();
    const std::size_t start = r_.units                             ? *r_.units + 1
                              : r_.header && !r_.header_in_comment ? *r_.header + 1
                                                                   : 0;
    for (std::size_t i = start; i < contents_.size() && !r_.first_data; ++i)
      if (!list().records[i].comment && (r_.header || contents_[i].numbers > 0)) r_.first_data = i;
    if (!r_.header && !header_row && r_.width > 0) find_header_in_comment();
    if (r_.header) r_.width = r_.names.size();
    grade();
  }

 private:
  CellList& list() { return r_.list; }

  Content content_of(const Record& record) {
    Content c;
    c.width = record.count;
    if (record.comment) return c;
    for (std::size_t i = 0; i < record.count; ++i) {
      const std::string_view cell = list().cell(record, i);
      const CellShape shape = shape_of(cell);
      if (shape.kind != CellKind::blank) c.trimmed = i + 1;
      switch (shape.kind) {
        case CellKind::blank:
          ++c.blanks;
          break;
        case CellKind::missing:
          ++(has_letter(cell) ? c.numbers : c.blanks);  // nan is a measurement that failed
          break;
        case CellKind::not_finite:
          ++c.numbers;
          break;
        case CellKind::number:
          if (decimal_ == 0 || shape.mark == 0 || shape.mark == decimal_) {
            ++c.numbers;
            c.numbers_size += cell.size();
          } else {
            ++c.texts;
          }
          break;
        case CellKind::grouped:
          ++(r_.separator == Separator::none || r_.separator == Separator::blanks ? c.texts
                                                                                  : c.numbers);
          break;
        case CellKind::text:
          ++c.texts;
          break;
      }
    }
    return c;
  }

  bool is_numeric(std::size_t i) const {
    return !r_.list.records[i].comment && contents_[i].numbers > 0;
  }

  /// Cells of most records with numbers: of two or more, if any has so many.
  std::size_t usual_width() const {
    std::map<std::size_t, std::size_t> count;
    std::size_t one = 0;
    for (std::size_t i = 0; i < contents_.size(); ++i)
      if (is_numeric(i)) ++(contents_[i].width > 1 ? count[contents_[i].width] : one);
    std::size_t width = one > 0 ? 1 : 0, most = 0;
    for (std::size_t i = 0; i < contents_.size();
         ++i) {  // in the file's order: the first of equals
      const auto found = count.find(contents_[i].width);
      if (is_numeric(i) && found != count.end() && found->second > most) {
        width = found->first;
        most = found->second;
      }
    }
    return width;
  }

  std::vector<std::string_view> cells_of(std::size_t i) const {
    const Record& record = r_.list.records[i];
    const auto first = r_.list.cells.begin() + static_cast<std::ptrdiff_t>(record.begin);
    return {first, first + static_cast<std::ptrdiff_t>(record.count)};
  }

  /// The names in a record, if there are as many as columns. Where blanks or tabs separate, a
  /// header may be padded by blanks with single ones inside its names.
  std::vector<std::string_view> names_of(std::size_t i) const {
    const Content& c = contents_[i];
    const Record& record = r_.list.records[i];
    std::vector<std::string_view> cells = cells_of(i);
    if (c.width >= used_ && c.trimmed <= r_.width) {
      cells.resize(std::min(cells.size(), r_.width));
      return cells;
    }
    if (r_.separator == Separator::tab || r_.separator == Separator::blanks) {
      cells = split_padded(record.line);
      if (cells.size() == r_.width) return cells;
    }
    return {};
  }

  std::vector<std::string_view> units_of(std::size_t i, std::size_t width) const {
    if (i >= contents_.size() || contents_[i].numbers > 0) return {};
    std::vector<std::string_view> cells = cells_of(i);
    if (cells.size() > width) cells.resize(std::max(width, contents_[i].trimmed));
    if (cells.size() == width && are_units(cells)) return cells;
    if (r_.separator == Separator::tab || r_.separator == Separator::blanks)
      for (auto* split : {split_padded, split_blanks})
        if (cells = split(r_.list.records[i].line); cells.size() == width && are_units(cells))
          return cells;
    return {};
  }

  /// The next record that is no comment, or what is a row of units for all that it starts with %.
  std::size_t after(std::size_t i, std::size_t width) const {
    ++i;
    while (i < contents_.size() && r_.list.records[i].comment && units_of(i, width).empty()) ++i;
    return i;
  }

  /// Do rows of data follow, below at most one row of units and rows with blank cells?
  bool leads_to_data(std::size_t i, std::size_t width) const {
    std::size_t next = after(i, width);
    if (!units_of(next, width).empty()) next = after(next, width);
    for (std::size_t sparse = 0; sparse < most_sparse_rows && next < contents_.size() &&
                                 !is_numeric(next) && contents_[next].blanks > 0;
         ++sparse)
      next = after(next, width);
    return next < contents_.size() && is_numeric(next) && contents_[next].width == r_.width;
  }

  void find_header() {
    used_ = 0;
    // A header stands above the first row that holds nothing but numbers. Above a column a year
    // may stand.
    std::size_t end = contents_.size(), seen = 0;
    for (std::size_t i = 0; i < contents_.size(); ++i) {
      if (!is_numeric(i) || contents_[i].width != r_.width) continue;
      used_ = std::max(used_, contents_[i].trimmed);
      if (contents_[i].texts > 0) continue;
      seen += contents_[i].numbers;
      if (seen > 1 && end == contents_.size()) end = i;
    }
    // names for all columns; for most; for some
    for (const int pass : {0, 1, 2})
      for (std::size_t i = 0; i < end; ++i) {
        if (r_.list.records[i].comment || contents_[i].numbers > 0) continue;
        const std::vector<std::string_view> names = names_of(i);
        if (names.empty()) continue;
        const auto blank =
            static_cast<std::size_t>(std::count_if(names.begin(), names.end(), [](auto n) {
              const CellKind kind = shape_of(n).kind;
              return kind == CellKind::blank || kind == CellKind::missing;
            }));
        if (blank == names.size() || (pass == 0 && blank > 0) ||
            (pass == 1 && 2 * blank > names.size()))
          continue;
        if (!leads_to_data(i, names.size())) continue;
        take_header(i, names);
        return;
      }
  }

  void take_header(std::size_t i, std::vector<std::string_view> names) {
    r_.header = i;
    r_.names = std::move(names);
    const std::size_t next = after(i, r_.names.size());
    r_.unit_texts = units_of(next, r_.names.size());
    if (!r_.unit_texts.empty()) r_.units = next;
  }

  void take_header_at(int row) {
    for (std::size_t i = 0; i < contents_.size(); ++i) {
      if (list().records[i].row != row) continue;
      std::vector<std::string_view> names = cells_of(i);
      if (list().records[i].comment) {
        names = names_in_comment(i);
        r_.header_in_comment = true;
      } else if (const auto padded = names_of(i); !padded.empty()) {
        names = padded;
      }
      take_header(i, names);
      r_.header_in_comment = false;
      return;
    }
  }

  std::vector<std::string_view> names_in_comment(std::size_t i) {
    const std::string_view line = list().records[i].line;
    const std::string_view text = comment_text(line);
    for (auto* split : {split_blanks, split_padded}) {
      if (r_.separator != Separator::blanks && r_.separator != Separator::tab) break;
      const auto cells = split(text);
      if (cells.size() == r_.width) return cells;
    }
    const CellList names = split_cells(text, r_.separator);
    if (names.records.empty()) return {};
    std::vector<std::string_view> cells(
        names.cells.begin(),
        names.cells.begin() + static_cast<std::ptrdiff_t>(names.records[0].count));
    // "#;q;u": the sign for a number is a name of its own
    if (cells.front().empty() && text.data() == trimmed(line).data() + 1)
      cells.front() = trimmed(line).substr(0, 1);
    for (const auto& cell : cells)
      for (const auto& copy : names.rewritten)
        if (cell.data() >= copy->data() && cell.data() < copy->data() + copy->size()) return {};
    return cells;
  }

  void find_header_in_comment() {
    if (!r_.first_data) return;
    for (std::size_t i = *r_.first_data; i-- > 0;) {
      if (!list().records[i].comment) return;
      const std::vector<std::string_view> names = names_in_comment(i);
      if (names.size() != r_.width) continue;
      const bool texts = std::none_of(names.begin(), names.end(), [](auto n) {
        const CellKind kind = shape_of(n).kind;
        return kind == CellKind::number || kind == CellKind::blank || kind == CellKind::grouped;
      });
      if (!texts || are_units(names)) continue;
      r_.header = i;
      r_.names = names;
      r_.header_in_comment = true;
      return;
    }
  }

  void grade() {
    if (!r_.first_data) return;
    std::size_t rows = 0, good = 0;
    for (std::size_t i = *r_.first_data; i < contents_.size(); ++i) {
      if (list().records[i].comment) continue;
      ++rows;
      if (!has_width(list(), list().records[i], r_.width)) continue;
      ++good;
      r_.numbers_size += contents_[i].numbers_size;
    }
    const bool any = std::any_of(contents_.begin(), contents_.end(),
                                 [](const Content& c) { return c.numbers > 0; });
    if (!any)
      r_.fit = Fit::none;
    else if (r_.header && good == rows)
      r_.fit = Fit::whole;
    else if (r_.header && 2 * good >= rows)
      r_.fit = Fit::mostly;
    else if (good == rows)
      r_.fit = text_above_first_data() ? Fit::poor : Fit::no_header;
    else
      r_.fit = Fit::poor;
    // a header with as many rows of data above it as below is a row that went wrong
    if (r_.header && !r_.header_in_comment) {
      std::size_t above = 0;
      for (std::size_t i = 0; i < *r_.header; ++i)
        above += is_numeric(i) && contents_[i].width == r_.width ? 1 : 0;
      if (above > 0 && above >= good) r_.fit = std::max(r_.fit, Fit::poor);
    }
    // one column is no reading of a header that has separators in it
    const std::string_view header = r_.header ? list().records[*r_.header].line : "";
    if (r_.separator == Separator::none && header.find_first_of(",;\t") != std::string_view::npos)
      r_.fit = std::max(r_.fit, Fit::doubtful);
    if (r_.separator == Separator::blanks && header.find_first_of(",;") != std::string_view::npos)
      r_.fit = std::max(r_.fit, Fit::mostly);
  }

  /// A row of text directly above the data that is no header here may be one to another separator.
  bool text_above_first_data() const {
    for (std::size_t i = *r_.first_data; i-- > 0;)
      if (!r_.list.records[i].comment) return contents_[i].numbers == 0;
    return false;
  }

  Reading& r_;
  char decimal_;
  std::vector<Content> contents_;
  std::size_t used_ = 0;  ///< columns that are not blank in every row
};

}  // namespace

Reading read_as(std::string_view text, Separator separator, char decimal,
                std::optional<int> header_row) {
  Reading reading;
  reading.separator = separator;
  reading.list = split_cells(text, separator);
  Judge(reading, decimal).judge(header_row);
  return reading;
}

bool has_width(const CellList& list, const Record& record, std::size_t width) {
  if (record.count < width) return false;
  for (std::size_t i = width; i < record.count; ++i)
    if (!list.cell(record, i).empty()) return false;
  return true;
}

bool are_units(const std::vector<std::string_view>& cells) {
  bool some = false;
  for (const std::string_view cell : cells) {
    if (cell.empty()) continue;
    const bool bracketed = cell.size() > 2 && ((cell.front() == '[' && cell.back() == ']') ||
                                               (cell.front() == '(' && cell.back() == ')'));
    if (!bracketed && !find_unit(cell)) return false;
    some = true;
  }
  return some;
}

}  // namespace repose::io
