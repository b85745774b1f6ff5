#pragma once
/// \file
/// What `repose stability` maps: the [law] and [stability] tables of an input file.

#include <optional>

#include "input/input_file.hpp"
#include "input/keys.hpp"
#include "models/registry.hpp"

namespace repose::input {

enum class StabilityPart : std::uint8_t { clay, mu_i, step, mpm, collapse };
/// Their names, in the same order.
constexpr std::array<std::string_view, 5> stability_names{"clay", "mu_i", "step", "mpm",
                                                          "collapse"};

struct StabilityInput {
  std::vector<StabilityPart> parts;
  LawSpec clay;        ///< modified_cam_clay
  LawSpec grains;      ///< mu_i
  std::string given;   ///< name of the law that the file has; "": the paper's two
  double p = 1e3;      ///< pressure of the maps of laws [Pa]
  bool quick = false;  ///< coarse maps, short runs
};

/// Reads it. A [law] table replaces the paper's law of the same name, and then the default of
/// `parts` is the part of that law alone. Throws BadInput.
StabilityInput read_stability(InputFile& file);

/// The keys of [stability].
void stability_keys(Keys& keys, StabilityInput& input);

/// The paper's laws and every part.
StabilityInput default_stability();

/// The same as an input file, with `origin` as a comment.
std::string stability_text(const StabilityInput& input, const std::string& origin);

}  // namespace repose::input
