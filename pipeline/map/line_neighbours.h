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
  struct Segment {
    Eigen::Vector2d from;
    Eigen::Vector2d to;
    int64_t id;  ///< of its line
  };

  LineNeighbours();
  ~LineNeighbours();

  void add(int64_t id, const std::vector<Eigen::Vector2d>& line);

  /// The share of `line` (0 to 1, by length) that has a line of the set within `reach_m`. Only
  /// lines whose id `counts` accepts are considered.
  double share_beside(const std::vector<Eigen::Vector2d>& line, double reach_m,
                      const std::function<bool(int64_t)>& counts) const;

  /// Whether the set has a segment within `reach_m` of `point` that `counts` accepts.
  bool has_near(const Eigen::Vector2d& point, double reach_m,
                const std::function<bool(const Segment&)>& counts) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace bevloc
