#include "input/toml_text.hpp"

#include <fmt/core.h>

namespace repose::input {

std::string toml_string(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      out += fmt::format("\\u{:04x}", static_cast<unsigned char>(c));
    else
      out += c;
  }
  return out + '"';
}

std::string toml_number(double x) {
  const std::string text = fmt::format("{}", x);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string toml_vector(const std::array<double, 3>& x, std::size_t axes) {
  std::string text = "[" + toml_number(x[0]);
  for (std::size_t i = 1; i < axes; ++i) text += ", " + toml_number(x[i]);
  return text + "]";
}

}  // namespace repose::input
