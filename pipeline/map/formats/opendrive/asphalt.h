// Where the roads of an OpenDRIVE file have asphalt.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pipeline/map/formats/area_cover.h"
#include "pipeline/map/formats/opendrive/section_lines.h"

namespace bevloc::opendrive {

/// The paved lanes of all roads. Immutable, and so thread-safe.
class Asphalt {
 public:
  explicit Asphalt(const std::vector<CutSection>& sections);

  /// Whether asphalt of the same height (kSameLevel_m) lies beside a piece of a section's border,
  /// on the side where the section has none. In a junction, asphalt of another road up to 3 m
  /// beside the piece also counts, because the small gaps between the roads of a junction are
  /// asphalt in truth.
  bool continues_beside(const CutSection& own, const Eigen::Vector3d& from,
                        const Eigen::Vector3d& to, bool left_paved) const;

 private:
  AreaCover cover_;
};

}  // namespace bevloc::opendrive
