#include "report/plot/svg_tidy.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fmt/core.h>

namespace repose::report {

namespace {

std::string xml_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '<') {
      out += "&lt;";
    } else if (c == '&') {
      out += "&amp;";
    } else {
      out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return out;
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  std::string out;
  std::size_t begin = 0;
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, begin)) {
    out.append(text, begin, at - begin);
    out += to;
    begin = at + from.size();
  }
  out.append(text, begin);
  text = std::move(out);
}

/// Removes every piece from `begin` to the next `end`, both included.
void remove_pieces(std::string& text, std::string_view begin, std::string_view end) {
  std::string out;
  std::size_t done = 0;
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, done)) {
    const std::size_t stop = text.find(end, at + begin.size());
    if (stop == std::string::npos) break;
    out.append(text, done, at - done);
    done = stop + end.size();
  }
  out.append(text, done);
  text = std::move(out);
}

/// Tinted areas with smooth edges; the colour bar keeps its crisp ones, or white lines would show.
void smooth_tints(std::string& svg) {
  constexpr std::string_view crisp = " shape-rendering='crispEdges'";
  constexpr std::size_t to_opacity = 100;  // "fill-opacity" follows within the first polygon
  for (std::size_t at = svg.find(crisp); at != std::string::npos; at = svg.find(crisp, at + 1))
    if (std::string_view(svg).substr(at, to_opacity).find("fill-opacity") != std::string::npos)
      svg.erase(at, crisp.size());
}

/// Open markers drawn with lines of 0.32 of their radius, about a pixel, instead of hair lines.
void stronger_markers(std::string& svg) {
  constexpr std::string_view marker = " id='gpPt", width = "stroke-width='";
  for (std::size_t at = svg.find(marker); at != std::string::npos; at = svg.find(marker, at + 1)) {
    const std::size_t begin = svg.find(width, at), end_of_line = svg.find('\n', at);
    if (begin == std::string::npos || begin > end_of_line) continue;
    const std::size_t number = begin + width.size();
    svg.replace(number, svg.find('\'', number) - number, "0.32");
  }
}

/// A dot of a cloud as gnuplot writes it, as a circle in half of the letters; the line itself if it
/// is anything else.
std::string shorter_dot(const std::string& line) {
  double x = 0.0, y = 0.0, radius = 0.0;
  unsigned red = 0, green = 0, blue = 0;
  int length = 0;
  std::sscanf(line.c_str(),
              " <use xlink:href='#gpPt6' transform='translate(%lf,%lf) scale(%lf)' "
              "color='rgb(%u, %u, %u)'/>%n",
              &x, &y, &radius, &red, &green, &blue, &length);
  if (length == 0 || static_cast<std::size_t>(length) != line.size()) return line;
  return fmt::format("<circle cx='{}' cy='{}' r='{}' fill='#{:02x}{:02x}{:02x}' stroke='none'/>", x,
                     y, radius, red, green, blue);
}

std::string shorter_dots(const std::string& svg) {
  std::string out;
  for (std::size_t begin = 0; begin < svg.size();) {
    const std::size_t end = std::min(svg.find('\n', begin), svg.size());
    out += shorter_dot(svg.substr(begin, end - begin)) + '\n';
    begin = end + 1;
  }
  return out;
}

}  // namespace

std::string tidy_svg(std::string svg, std::string_view title) {
  remove_pieces(svg, "<desc>", "</desc>\n");
  remove_pieces(svg, "<title>gnuplot_plot_", "</title>");
  remove_pieces(svg, " id=\"gnuplot_", "\"");  // the same in every picture of a page
  stronger_markers(svg);
  replace_all(svg, "<title>Gnuplot</title>", "<title>" + xml_text(title) + "</title>");
  replace_all(svg, " font-family=\"sans-serif\"", "");
  // Some readers swallow a space after a subscript unless they are told to keep it.
  replace_all(svg, " xmlns=\"http://www.w3.org/2000/svg\"",
              " xmlns=\"http://www.w3.org/2000/svg\"\n xml:space=\"preserve\" "
              "font-family=\"Helvetica, Arial, "
              "'Liberation Sans', 'DejaVu Sans', sans-serif\"");
  smooth_tints(svg);
  return shorter_dots(svg);
}

}  // namespace repose::report
