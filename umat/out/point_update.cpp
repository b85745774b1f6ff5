#include "umat/out/point_update.hpp"

#include "umat/out/library_updates.hpp"

namespace repose::umat {

PointUpdate::~PointUpdate() = default;

std::unique_ptr<PointUpdate> make_point_update(const LawInfo& law, std::span<const double> theta) {
  return visit_law(law, [&]<class L>(L) -> std::unique_ptr<PointUpdate> {
    return std::make_unique<LawPointUpdate<L>>(theta);
  });
}

}  // namespace repose::umat
