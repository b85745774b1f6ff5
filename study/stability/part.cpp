#include "study/stability/part.hpp"

#include <cmath>

#include "input/read_scene.hpp"
#include "input/shipped_input.hpp"

namespace repose::study {

std::vector<double> decades(double low, double high, int n) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(low * std::pow(high / low, i / (n - 1.0)));
  return values;
}

mpm::Scene paper_scene(std::string_view name, const std::vector<std::string>& sets) {
  input::InputFile file = input::open_scene(std::string(name), sets);
  return input::read_scene(file).scene;
}

}  // namespace repose::study
