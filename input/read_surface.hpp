#pragma once
/// \file
/// The keys of a [[surface]], and of a polygon, which a body may be too.

#include <string_view>

#include "input/keys.hpp"
#include "mpm/scene/solid.hpp"

namespace repose::input {

/// Corners [[x, y], …], three at least.
void corners_key(Keys& keys, const Key& key, mpm::Polygon& polygon);

/// The key `kind` of a contact beside its key `friction`, of which one is given: no slip if neither
/// is. `rubs`: friction is; `what`: for the message.
void contact_kind_key(Keys& keys, bool rubs, std::string_view what, mpm::Surface::Contact& contact);

/// axes: of the scene, 2 or 3.
void surface_keys(Keys& keys, mpm::Surface& surface, std::size_t axes);

}  // namespace repose::input
