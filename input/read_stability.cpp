#include "input/read_stability.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "input/read_law.hpp"
#include "input/read_scene.hpp"
#include "input/resolved_scene.hpp"
#include "input/shipped_input.hpp"

namespace repose::input {
namespace {

LawSpec law_of(const char* scene) {
  InputFile file = open_scene(scene);
  return read_scene(file).scene.bodies.front().law;
}

}  // namespace

StabilityInput default_stability() {
  StabilityInput input;
  for (std::size_t k = 0; k < stability_names.size(); ++k)
    input.parts.push_back(static_cast<StabilityPart>(k));
  input.clay = law_of("flat_mcc");
  input.grains = law_of("flat_mu_i");
  return input;
}

StabilityInput read_stability(InputFile& file) {
  StabilityInput input = default_stability();
  TomlReader root(file);
  root.expect("law");
  root.expect("stability");
  if (!root.has("law") && !root.has("stability"))
    throw BadInput(
        {fmt::format("{}: `repose stability` takes a file with a [law] table, a "
                     "[stability] table or both",
                     file.name())});
  if (root.has("law")) {
    const LawSpec law = read_law(root.table("law"));
    input.given = law.name;
    if (law.name == "modified_cam_clay") {
      input.clay = law;
      input.parts = {StabilityPart::clay};
    } else if (law.name == "mu_i") {
      input.grains = law;
      input.parts = {StabilityPart::mu_i};
    } else if (file.ok()) {
      file.report("law.name",
                  fmt::format("there are maps of modified_cam_clay and mu_i, not of {}", law.name));
    }
  }
  if (root.has("stability")) {
    TomlReader table = root.table("stability");
    if (const auto parts =
            table.choices("parts", {stability_names.begin(), stability_names.end()})) {
      input.parts.clear();
      for (const std::size_t k : *parts) input.parts.push_back(static_cast<StabilityPart>(k));
    }
    input.p = table.number({"p", "Pa", "pressure of the maps of laws", positive, input.p});
    input.quick = table.boolean("quick", false);
  }
  file.throw_if_bad();
  return input;
}

std::string stability_text(const StabilityInput& input, const std::string& origin) {
  std::vector<std::string> parts;
  for (const StabilityPart part : input.parts)
    parts.push_back(fmt::format("\"{}\"", stability_names[static_cast<std::size_t>(part)]));
  std::string text = fmt::format("# {}\n\n[stability]\nparts = [{}]\np = {}  # Pa\nquick = {}\n",
                                 origin, fmt::join(parts, ", "), input.p, input.quick);
  if (input.given == "modified_cam_clay") text += law_table(input.clay, "law");
  if (input.given == "mu_i") text += law_table(input.grains, "law");
  return text;
}

}  // namespace repose::input
