#include "mpm/boundary/wall_parts.hpp"

#include <algorithm>
#include <cmath>

namespace repose::mpm {

template <int dim>
WallParts<dim>::WallParts(const Wall& wall, std::size_t normal, const GridOf<dim>& grid)
    : wall_(wall),
      h_(grid.h()),
      hair_(lattice_tolerance * grid.h()) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i] = i < normal ? i : i + 1;
    length_[i] = grid.h() * grid.cells()[axes_[i]];
  }
}

template <int dim>
const Wall::Part& WallParts<dim>::at(Place place) const {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (place[i] < 0.0) place[i] = -place[i];
    if (place[i] > length_[i]) place[i] = 2.0 * length_[i] - place[i];
    place[i] = std::clamp(place[i], 0.0, length_[i] - 2.0 * hair_);
  }
  for (const Wall::Part& part : wall_.parts) {
    bool inside = true;
    for (std::size_t i = 0; i < axes_.size(); ++i)
      inside = inside && place[i] >= part.from[i] - hair_ && place[i] < part.to[i] - hair_;
    if (inside) return part;
  }
  return wall_.parts.back();  // validate() has found every place covered, but for round-off
}

template <int dim>
bool WallParts<dim>::open_at(const std::array<double, dim>& x) const {
  Place place{};
  for (std::size_t i = 0; i < axes_.size(); ++i) place[i] = x[axes_[i]];
  return at(place).kind == Wall::Kind::open;
}

template <int dim>
bool WallParts<dim>::open_near(const std::array<double, dim>& x) const {
  for (const std::size_t axis : axes_)
    for (const double by : {-2.0 * h_, 2.0 * h_}) {
      std::array<double, dim> beside = x;
      beside[axis] += by;
      if (open_at(beside)) return true;
    }
  return false;
}

template <int dim>
typename WallParts<dim>::Node WallParts<dim>::node(const std::array<int, dim - 1>& index) const {
  Place place{};
  for (std::size_t i = 0; i < index.size(); ++i) place[i] = h_ * index[i];
  Node node{&at(place), {}, {}};
  node.share.fill(1.0);
  if (node.part->kind != Wall::Kind::open) return node;
  for (std::size_t i = 0; i < index.size(); ++i) {
    double nearest = h_ - hair_;
    for (const Wall::Part& part : wall_.parts)
      for (const double end : {part.from[i], part.to[i]})
        for (const int side : {-1, 1}) {
          const double r = side * (end - place[i]);
          if (!(r > -hair_ && r < nearest)) continue;
          Place beyond = place;
          beyond[i] = end + side * 2.0 * hair_;
          if (beyond[i] < 0.0 || beyond[i] > length_[i]) continue;
          const Wall::Part& there = at(beyond);
          if (there.kind == Wall::Kind::open) continue;
          nearest = std::max(r, 0.0);
          if (r < hair_) {  // it lies on the lip
            node.part = &there;
            node.share.fill(1.0);
            return node;
          }
          node.share[i] = r * r / (h_ * (r + h_));
          node.towards_lip[i] = side;
        }
  }
  return node;
}

template class WallParts<2>;
template class WallParts<3>;

}  // namespace repose::mpm
