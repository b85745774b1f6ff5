#include "input/read_stability.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "input/read_keys.hpp"
#include "input/read_law.hpp"
#include "input/read_scene.hpp"
#include "input/resolved_scene.hpp"
#include "input/shipped_input.hpp"
#include "input/write_keys.hpp"

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
    ReadKeys keys(root.table("stability"));
    stability_keys(keys, input);
  }
  file.throw_if_bad();
  return input;
}

void stability_keys(Keys& keys, StabilityInput& input) {
  keys.choices({"parts", "-", "which maps; all by default"}, stability_names, input.parts);
  keys.number({"p", "Pa", "pressure of the maps of laws", positive}, input.p);
  keys.boolean({"quick", "-", "coarse maps and short runs"}, input.quick);
}

std::string stability_text(const StabilityInput& input, const std::string& origin) {
  StabilityInput copy = input;
  std::string text = fmt::format("# {}\n", origin) + write_keys([&](Keys& keys) {
                       keys.table({"stability"}, [&](Keys& k) { stability_keys(k, copy); });
                     });
  if (input.given == "modified_cam_clay") text += law_table(input.clay, "law");
  if (input.given == "mu_i") text += law_table(input.grains, "law");
  return text;
}

}  // namespace repose::input
