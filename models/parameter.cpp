#include "models/parameter.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>

namespace repose {
namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", x);
  return text;
}

int edit_distance(std::string_view a, std::string_view b, bool ignore_case) {
  std::vector<int> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = a[i - 1] == b[j - 1] ||
                        (ignore_case && std::tolower(static_cast<unsigned char>(a[i - 1])) ==
                                            std::tolower(static_cast<unsigned char>(b[j - 1])));
      const int change = diagonal + (same ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({change, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string to_string(const Range& range) {
  const bool low = std::isfinite(range.lower);
  const bool high = std::isfinite(range.upper);
  if (!low && !high) return "any number";
  if (!high) return (range.lower_open ? "> " : ">= ") + number(range.lower);
  if (!low) return (range.upper_open ? "< " : "<= ") + number(range.upper);
  return (range.lower_open ? "(" : "[") + number(range.lower) + ", " + number(range.upper) +
         (range.upper_open ? ")" : "]");
}

std::string nearest_name(std::string_view misspelt, std::span<const std::string_view> known) {
  std::string_view best;
  const int most = std::max(1, static_cast<int>(misspelt.size()) / 3);
  int best_distance = most + 1;
  int best_with_case = 0;  // decides between equals: "Nx" means N rather than nu
  for (const std::string_view name : known) {
    const int distance = edit_distance(misspelt, name, true);
    const int with_case = edit_distance(misspelt, name, false);
    if (distance < best_distance ||
        (distance == best_distance && distance <= most && with_case < best_with_case)) {
      best = name;
      best_distance = distance;
      best_with_case = with_case;
    }
  }
  return std::string(best);
}

std::vector<double> parameter_vector(std::string_view law, std::span<const ParamInfo> table,
                                     const std::map<std::string, double>& given) {
  std::vector<std::string_view> names, known;
  for (const ParamInfo& info : table) {
    names.push_back(info.name);
    known.push_back(info.name);
    if (!info.angle.name.empty()) known.push_back(info.angle.name);
  }
  for (const auto& [name, x] : given) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    for (const ParamInfo& info : table)
      if (info.angle.name == name)
        throw InputError(name, name + " is what an input file may say instead of " +
                                   std::string(info.name) + ": here the parameter is " +
                                   std::string(info.name) +
                                   " itself (models/cone.hpp turns an angle into it)");
    std::string message = std::string(law) + " has no parameter '" + name + "'";
    const std::string near = nearest_name(name, known);
    if (!near.empty()) {
      message += "; did you mean '" + near + "'?";
    } else {
      message += "; it has:";
      for (std::size_t i = 0; i < names.size(); ++i)
        message += (i == 0 ? " " : ", ") + std::string(names[i]);
    }
    throw InputError(name, message);
  }
  std::vector<double> theta;
  for (const ParamInfo& info : table) {
    const std::string name(info.name);
    const std::string unit = info.unit == "-" ? "" : " " + std::string(info.unit);
    const auto found = given.find(name);
    if (found == given.end()) {
      if (info.need == Need::required)
        throw InputError(name,
                         std::string(law) + " needs " + name + " (" + std::string(info.doc) +
                             "), a number " + to_string(info.range) + unit +
                             (info.angle.name.empty() ? ""
                                                      : ", or " + std::string(info.angle.name) +
                                                            ", its friction angle in degrees"));
      theta.push_back(info.need == Need::defaulted ? info.value
                                                   : std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const double x = found->second;
    if (!std::isfinite(x) || !info.range.contains(x))
      throw InputError(name, name + " = " + number(x) + unit +
                                 " is out of range: " + std::string(info.doc) + " must be " +
                                 to_string(info.range) + unit);
    if (!info.words.empty() && x != std::floor(x))
      throw InputError(name, name + " is the position of a word, and " + number(x) + " is none");
    theta.push_back(x);
  }
  return theta;
}

}  // namespace repose
