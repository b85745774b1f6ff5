#pragma once
/// \file
/// The laws by name: what input files and the programs around a law need. all_laws.hpp has their
/// types.

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "models/material.hpp"

namespace repose {

/// A law as an input file writes it.
struct LawSpec {
  std::string name;
  std::map<std::string, std::string> options;  ///< option key → value, e.g. form = "regularised"
  std::map<std::string, double> values;        ///< parameter → value in SI units
};

/// All forms of all laws, in the order of AllLaws.
std::span<const LawInfo> all_laws();

/// The form of `name` that applies if its option is left out, or null if the option is required.
const LawInfo* default_form(std::string_view name);

/// Derives the values of absent (NaN) optional parameters where the law knows how, and checks
/// conditions between parameters. Throws InputError.
void complete_parameters(const LawInfo& law, std::vector<double>& theta);

/// Finds the form, checks and completes the parameters. Throws InputError; its key is a parameter's
/// or option's name, or "name".
const LawInfo& find_law(const LawSpec& spec);
std::vector<double> checked_parameters(const LawSpec& spec);
std::unique_ptr<Material> make_material(const LawSpec& spec);

}  // namespace repose
