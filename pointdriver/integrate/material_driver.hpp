#pragma once
/// \file
/// The point driver of a law that is known only by its Material, batch by batch: the method
/// `implicit`, whose Newton iterations take the tangent by central differences of the update.

#include <functional>
#include <memory>

#include "pointdriver/integrate/outside_driver.hpp"

namespace repose::point {

/// `complete` and `make` are those of the law's OutsideLaw. Derivatives with respect to parameters
/// and start are central differences of whole paths over 1e-5 of the numbers they move.
std::shared_ptr<const OutsideDriver> material_driver(
    const LawInfo& info, std::function<void(std::vector<double>&)> complete,
    std::function<std::unique_ptr<Material>(std::vector<double>)> make);

}  // namespace repose::point
