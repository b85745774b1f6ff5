#pragma once
/// \file
/// The keys of a [[surface]], and of its shapes, which a body may be too.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "input/keys.hpp"
#include "mpm/scene/scene.hpp"

namespace repose::input {

/// The keys of the shapes "half_space", "ball", "polygon", "curve", "cylinder" and "mesh"; those
/// that `shape` has not are refused. Files are read, and what is wrong with them reported. `disc`:
/// of a body that is a "disc" or, without an axis, a "cylinder", whose centre and radius go there.
void shape_keys(Keys& keys, std::string_view shape, std::size_t axes, mpm::Solid& solid,
                mpm::Disc* disc = nullptr);

/// The line of a curve from the bytes of its table, in metres: of the columns `x` and `y` of the
/// curve, in its unit where the table names none. Errors: TableError with the row.
std::shared_ptr<const mpm::PolyLine> line_of(std::string bytes, const std::string& name,
                                             const mpm::Curve& curve, bool closed);

/// The surface of a mesh, scaled and shifted as it says, from the bytes of its file. Errors:
/// TableError for what is no STL file, and with the triangle for what is no closed surface.
std::shared_ptr<const mpm::TriangleMesh> mesh_of(const std::string& bytes, const std::string& name,
                                                 const mpm::Mesh& mesh);

/// [[name]], each a shape that may be hollow.
void solids_key(Keys& keys, const Key& key, std::size_t axes, std::vector<mpm::Solid>& solids);

/// "ball"
std::string_view shape_name(const mpm::Solid& solid);

/// The key `kind` of a contact beside its key `friction`, of which one is given: no slip if neither
/// is. `rubs`: friction is; `what`: for the message.
void contact_kind_key(Keys& keys, bool rubs, std::string_view what, mpm::Surface::Contact& contact);

/// axes: of the scene, 2 or 3.
void surface_keys(Keys& keys, mpm::Surface& surface, std::size_t axes);

}  // namespace repose::input
