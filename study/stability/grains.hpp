#pragma once
/// \file
/// What the maps of μ(I) share.

#include <map>
#include <memory>

#include "models/registry.hpp"
#include "pointdriver/study/plane_wave.hpp"

namespace repose::study {

/// Growth rates within this share of ηk²/ρ are too close to neutral to be judged.
inline constexpr double neutral_margin = 0.002;

/// The grains as another form and with other values. G follows K.
LawSpec grains_as(const LawSpec& law, const std::string& form,
                  const std::map<std::string, double>& values);

/// Shear at an inertial number.
point::ShearFlow flow_of(const Material& material, double p, double I);

}  // namespace repose::study
