#pragma once
/// \file
/// A binary tree of boxes around the parts of a surface, by which those near a place are found.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "mpm/scene/nearest.hpp"

namespace repose::mpm {

class BoxTree {
 public:
  struct Box {
    Position low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    void add(const Position& x) {
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], x[k]);
        high[k] = std::max(high[k], x[k]);
      }
    }
    bool meets(const Box& other) const {
      for (std::size_t k = 0; k < 3; ++k)
        if (low[k] > other.high[k] || high[k] < other.low[k]) return false;
      return true;
    }
    /// From a place to the box, squared; 0 within [m²].
    double distance2(const Position& x) const {
      double sum = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double d = std::max({low[k] - x[k], 0.0, x[k] - high[k]});
        sum += d * d;
      }
      return sum;
    }
  };

  BoxTree() = default;
  /// One box for each part; halved by number along the longest side of their middles.
  explicit BoxTree(const std::vector<Box>& parts);

  const Box& bounds() const { return nodes_.front().box; }

  /// Calls look(part, best) for the parts that may be nearer to x than `best` [m²], which look()
  /// lowers; nearer boxes first.
  template <class Look>
  void near_to(const Position& x, double& best, Look&& look) const {
    std::array<std::pair<std::uint32_t, double>, most_deep> waiting;
    std::size_t count = 0;
    waiting[count++] = {0, nodes_.front().box.distance2(x)};
    while (count > 0) {
      const auto [at, distance2] = waiting[--count];
      if (!(distance2 < best)) continue;
      const Node& node = nodes_[at];
      if (node.parts > 0) {
        for (std::uint32_t k = 0; k < node.parts; ++k) look(order_[node.first + k], best);
        continue;
      }
      std::pair<std::uint32_t, double> low{node.first, nodes_[node.first].box.distance2(x)};
      std::pair<std::uint32_t, double> high{node.first + 1,
                                            nodes_[node.first + 1].box.distance2(x)};
      if (high.second < low.second) std::swap(low, high);
      waiting[count++] = high;
      waiting[count++] = low;
    }
  }

  /// Calls f(part) for the parts whose boxes meet a box.
  template <class F>
  void each_meeting(const Box& box, F&& f) const {
    std::array<std::uint32_t, most_deep> waiting;
    std::size_t count = 0;
    waiting[count++] = 0;
    while (count > 0) {
      const Node& node = nodes_[waiting[--count]];
      if (!node.box.meets(box)) continue;
      for (std::uint32_t k = 0; k < node.parts; ++k)
        if (boxes_[order_[node.first + k]].meets(box)) f(order_[node.first + k]);
      if (node.parts > 0) continue;
      waiting[count++] = node.first + 1;
      waiting[count++] = node.first;
    }
  }

 private:
  /// A leaf of `parts` of the order from `first` on; or with none, the two nodes from `first` on.
  struct Node {
    Box box;
    std::uint32_t first = 0, parts = 0;
  };
  static constexpr std::size_t most_deep = 128;  ///< halving 2³² parts takes 32

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace repose::mpm
