// Finds which lines of a map run beside each other.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <Eigen/Core>

namespace bevloc {

/// A set of lines, each with an id.
class LineNeighbours {
 public:
  LineNeighbours();
  ~LineNeighbours();

  void add(int64_t id, const std::vector<Eigen::Vector2d>& line);

  /// The share of `line` (0 to 1, by length) that has a line of the set within `reach_m`. Only
  /// lines whose id `counts` accepts are considered.
  double share_beside(const std::vector<Eigen::Vector2d>& line, double reach_m,
                      const std::function<bool(int64_t)>& counts) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace bevloc
