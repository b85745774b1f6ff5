#include "report/stability/part.hpp"

#include <cmath>

#include <fmt/format.h>

#include "input/read_scene.hpp"
#include "input/shipped_input.hpp"
#include "report/plot/gnuplot.hpp"

namespace repose::report {

void PartOutput::table(const std::string& name, const std::string& csv) {
  folder_->write_file(name, csv);
  files_.push_back(name);
}

void PartOutput::picture(const std::string& name, const Figure& figure) {
  if (!plot_) return;
  try {
    figure.render_svg(folder_->file(name));
    files_.push_back(name);
  } catch (const PlotError& error) {
    fmt::print(stderr, "warning: no {}: {}\n", name, error.what());
  } catch (const std::logic_error& error) {  // nothing to draw
    fmt::print(stderr, "warning: no {}: {}\n", name, error.what());
  }
}

void PartOutput::tell(const std::string& line) const {
  if (quiet_) return;
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

std::vector<double> decades(double low, double high, int n) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(low * std::pow(high / low, i / (n - 1.0)));
  return values;
}

mpm::Scene paper_scene(std::string_view name, const std::vector<std::string>& sets) {
  input::InputFile file = input::open_scene(std::string(name), sets);
  return input::read_scene(file).scene;
}

}  // namespace repose::report
