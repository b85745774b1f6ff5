#include "mpm/scene/box_tree.hpp"

#include <numeric>
#include <utility>

namespace repose::mpm {

BoxTree::BoxTree(const std::vector<Box>& parts) : boxes_(parts), order_(parts.size()) {
  constexpr std::uint32_t of_leaf = 4;
  std::iota(order_.begin(), order_.end(), 0U);
  struct Task {
    std::uint32_t node, first, count;
  };
  nodes_.emplace_back();
  std::vector<Task> tasks{{0, 0, static_cast<std::uint32_t>(parts.size())}};
  while (!tasks.empty()) {
    const Task task = tasks.back();
    tasks.pop_back();
    Box box, middles;
    const auto middle = [&](std::uint32_t part, std::size_t axis) {
      return 0.5 * (boxes_[part].low[axis] + boxes_[part].high[axis]);
    };
    for (std::uint32_t k = 0; k < task.count; ++k) {
      const std::uint32_t part = order_[task.first + k];
      box.add(boxes_[part].low);
      box.add(boxes_[part].high);
      middles.add({middle(part, 0), middle(part, 1), middle(part, 2)});
    }
    nodes_[task.node].box = box;
    if (task.count <= of_leaf) {
      nodes_[task.node].first = task.first;
      nodes_[task.node].parts = task.count;
      continue;
    }
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (middles.high[k] - middles.low[k] > middles.high[axis] - middles.low[axis]) axis = k;
    const std::uint32_t half = task.count / 2;
    const auto begin = order_.begin() + task.first;
    // parts that are alike keep the order they came in, whatever the library's algorithm
    std::nth_element(begin, begin + half, begin + task.count,
                     [&](std::uint32_t a, std::uint32_t b) {
                       const double x = middle(a, axis), y = middle(b, axis);
                       return x < y || (x == y && a < b);
                     });
    const auto below = static_cast<std::uint32_t>(nodes_.size());
    nodes_[task.node].first = below;
    nodes_.resize(nodes_.size() + 2);
    tasks.push_back({below + 1, task.first + half, task.count - half});
    tasks.push_back({below, task.first, half});
  }
}

}  // namespace repose::mpm
