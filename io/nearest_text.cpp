#include "io/nearest_text.hpp"

#include <algorithm>

#include <fmt/core.h>

namespace repose::io {
namespace {

constexpr std::size_t longest = 200;  ///< beyond it nothing is compared

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

/// Levenshtein's distance.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, changed});
    }
  }
  return row.back();
}

}  // namespace

std::vector<std::string> nearest_texts(std::string_view misspelt,
                                       const std::vector<std::string>& known) {
  std::vector<std::pair<std::size_t, std::string>> found;
  const std::string word = lower(misspelt);
  const std::size_t most = std::max<std::size_t>(1, word.size() / 3);
  for (const std::string& candidate : known) {
    if (word.size() < 2 || candidate.size() > longest || word.size() > longest) continue;
    const std::string other = lower(candidate);
    const std::size_t d = distance(word, other);
    if (d <= most)
      found.emplace_back(d, candidate);
    else if (word.size() >= 3 && other.find(word) != std::string::npos)
      found.emplace_back(most + 1, candidate);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> best;
  for (auto& [d, candidate] : found)
    if (best.size() < 3 && std::find(best.begin(), best.end(), candidate) == best.end())
      best.push_back(std::move(candidate));
  return best;
}

std::string did_you_mean(std::string_view misspelt, const std::vector<std::string>& known) {
  const std::vector<std::string> best = nearest_texts(misspelt, known);
  if (best.empty()) return "";
  std::string text = "did you mean ";
  for (std::size_t i = 0; i < best.size(); ++i)
    text += fmt::format("{}\"{}\"", i == 0 ? "" : i + 1 == best.size() ? " or " : ", ", best[i]);
  return text + "?";
}

}  // namespace repose::io
