#include "report/page/page.hpp"

#include <initializer_list>
#include <stdexcept>
#include <utility>

#include "embedded_report.hpp"
#include "io/json.hpp"
#include "repose_version.hpp"

namespace repose::report {
namespace {

using Json = io::Json;

/// The page with a text in the place of each mark; the marks in the order in which they stand.
std::string fill(std::string_view page,
                 std::initializer_list<std::pair<std::string_view, std::string_view>> texts) {
  std::string out;
  for (const auto& [mark, text] : texts) {
    const std::size_t at = page.find(mark);
    if (at == page.npos) throw std::logic_error("report page: no " + std::string(mark));
    out += page.substr(0, at);
    out += text;
    page.remove_prefix(at + mark.size());
  }
  return out.append(page);
}

}  // namespace

std::string html_text(std::string_view text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  return out;
}

std::string script_json(const Json& data) {
  const std::string json = data.dump();
  std::string out;
  out.reserve(json.size());
  for (const char c : json)
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  return out;
}

std::string report_page(std::span<const Json> results, std::string_view title) {
  Json data{{"repose", version_string}, {"title", title}, {"results", Json::array()}};
  for (const Json& result : results) data["results"].push_back(result);
  std::string script;
  for (const std::string_view part : report_scripts) script += part;
  return fill(report_html, {{"<!--title-->", html_text(title)},
                            {"/*style*/", report_css},
                            {"<!--data-->", script_json(data)},
                            {"/*script*/", script}});
}

}  // namespace repose::report
