#include "pointdriver/integrate/outside_driver.hpp"

namespace repose::point {

OutsideDriver::~OutsideDriver() = default;

const OutsideDriver& outside_driver(const LawInfo& law) {
  const OutsideLaw* const outside = find_outside(law);
  const auto* const driver =
      outside == nullptr ? nullptr : dynamic_cast<const OutsideDriver*>(outside->point.get());
  if (driver == nullptr)
    throw InputError("name", "the law \"" + std::string(law.name) +
                                 "\" was registered without a point driver: register it with "
                                 "repose::point::register_law (integrate/register_law.hpp)");
  return *driver;
}

}  // namespace repose::point
