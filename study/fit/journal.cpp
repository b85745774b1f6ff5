#include "study/fit/journal.hpp"

#include <cmath>
#include <cstdio>
#include <fstream>

#include <fmt/core.h>

#include "input/input_file.hpp"
#include "io/fingerprint.hpp"
#include "io/progress.hpp"
#include "io/result_folder.hpp"

namespace repose::study {
namespace {

/// Whether a line is the one that was written: its last member is the checksum of the line without
/// it.
bool has_own_checksum(const std::string& line, const io::Json& json) {
  const std::string sum = json.value("checksum", "");
  const std::string tail = fmt::format(",\"checksum\":\"{}\"}}", sum);
  return line.ends_with(tail) &&
         sum == io::fingerprint_of(line.substr(0, line.size() - tail.size()) + "}");
}

}  // namespace

std::string journal_line(const io::Json& entry) {
  const std::string line = entry.dump();
  return fmt::format("{},\"checksum\":\"{}\"}}\n", line.substr(0, line.size() - 1),
                     io::fingerprint_of(line));
}

io::Json number(double x) { return std::isfinite(x) ? io::Json(x) : io::Json(nullptr); }

io::Json list(const Eigen::VectorXd& v) {
  io::Json out = io::Json::array();
  for (const double x : v) out.push_back(number(x));
  return out;
}

Eigen::VectorXd vector_of(const io::Json& list) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(list.size()));
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    const io::Json& x = list[static_cast<std::size_t>(i)];
    v[i] = x.is_null() ? std::nan("") : x.get<double>();
  }
  return v;
}

void read_journal(const std::filesystem::path& path, std::string_view what,
                  const std::string& fingerprint,
                  const std::function<void(const io::Json&)>& each) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return;
  std::ifstream in(path);
  if (!in) throw io::IoError(path, "cannot read", errno);
  std::string line;
  bool first = true;
  while (std::getline(in, line)) {
    const bool whole = !in.eof();
    const auto json = io::Json::try_parse(line);
    if (!json || !whole) break;  // cut short by a kill
    if (!first && !has_own_checksum(line, *json)) {
      io::warn_of_damage(path.string(), fmt::format("a {} is not as it was written", what),
                         "so it and those behind it are made again");
      break;
    }
    if (first) {
      first = false;
      if (json->value("fingerprint", "") != fingerprint)
        throw input::BadInput(
            {fmt::format("{}: these {}s belong to another fit (input, data or seed "
                         "differ); use another folder, or start anew without --resume",
                         path.string(), what)});
      continue;
    }
    try {
      each(*json);
    } catch (const io::Json::Error&) {
      throw input::BadInput({fmt::format("{}: not a journal of {}s", path.string(), what)});
    }
  }
}

bool append(const std::filesystem::path& path, const std::string& text) {
  FILE* out = std::fopen(path.c_str(), "ab");
  if (out == nullptr) return false;
  const bool good = std::fwrite(text.data(), 1, text.size(), out) == text.size();
  return std::fclose(out) == 0 && good;
}

}  // namespace repose::study
