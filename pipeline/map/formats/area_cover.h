// The union of many areas, such as all asphalt of a map: what it covers, and where it ends.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pipeline/map/formats/map_builder.h"

namespace bevloc {

/// An area with holes. The rings may run in either direction, with or without a repeated corner.
struct Area {
  Line3 outer;
  std::vector<Line3> holes{};
  size_t owner = 0;  ///< the number of what it belongs to, such as its road
};

/// Areas whose heights differ by more than this, in metres, are above each other, as a bridge is
/// above a road.
inline constexpr double kSameLevel_m = 3.0;

/// The longest outline of an area. Outlines are sampled every 0.5 m, so a wrong coordinate would
/// take minutes.
inline constexpr double kLongestOutline_m = 200'000.0;

/// Returns true if the outline is short enough to be sampled. If it is not, the builder reports
/// that the area at `place` was left out. Calls `place` only then, because it searches the text of
/// the file.
bool take_outline(const Line3& outline, const std::function<std::string()>& place,
                  MapBuilder& builder);

/// Immutable, and so thread-safe.
class AreaCover {
 public:
  explicit AreaCover(std::vector<Area> areas);
  AreaCover(AreaCover&&) noexcept;
  AreaCover& operator=(AreaCover&&) noexcept;
  ~AreaCover();

  /// Whether a point lies in at least one area of its height (kSameLevel_m). The height of an area
  /// is that of its outline where the point is nearest to it. Heights that are not finite are not
  /// compared. The areas of `ignored_owner` do not count.
  bool covers(const Eigen::Vector3d& point,
              std::optional<size_t> ignored_owner = std::nullopt) const;

  /// The parts of the outlines of area `index` where no area of the same height lies beside them,
  /// cut to about 0.5 m.
  std::vector<Line3> outline_of(size_t index) const;

  const std::vector<Area>& areas() const { return areas_; }

 private:
  struct Tree;

  std::vector<Area> areas_;
  std::unique_ptr<const Tree> tree_;
};

/// The distance beside an edge, in metres, at which another area is looked for.
inline constexpr double kBesideArea_m = 0.25;

}  // namespace bevloc
