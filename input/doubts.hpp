#pragma once
/// \file
/// Inputs that are possible and hardly meant.

#include <span>
#include <string>
#include <vector>

#include "models/material.hpp"

namespace repose::input {

/// Reasons to doubt that a law and its start are meant as they are given (a warning each): grains
/// of metres, grains lighter than their packing, clay under less than a kilopascal.
std::vector<std::string> doubts(const LawInfo& law, std::span<const double> theta,
                                const InitialConditions& initial);

}  // namespace repose::input
