// What the bench looks at: places of a simulated world and the pictures taken there.
#pragma once

#include <array>
#include <vector>

#include "common/image.h"
#include "common/result.h"
#include "common/se2.h"
#include "firmware/config.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/map/hd_map.h"
#include "sim/render/renderer.h"
#include "sim/world/world.h"

namespace bevloc::bench {

using Pictures = std::array<RgbImage, kCameraCount>;

/// Somewhere on a road, where the vehicle stands.
struct Place {
  Se2 map_from_vehicle;
  std::vector<Pictures> framesets;  ///< one after the other: traffic moves, noise changes
};

struct Scene {
  Rig rig;
  HdMap map;
  std::vector<Place> places;

  double pictures_mib() const;
};

/// Draws the configuration's world through its rig.
class SceneDrawer {
 public:
  /// Fails where map or rig do, and for a map without lanes.
  static Result<SceneDrawer> create(const firmware::Config& config);

  const Rig& rig() const { return rig_; }
  const HdMap& map() const { return world_.map; }

  /// The same number gives the same place, one that only evaluation sees.
  Place draw(int number, int framesets) const;

 private:
  SceneDrawer(const Rig& rig, sim::World world, const sim::Conditions& conditions);

  Rig rig_;
  sim::World world_;
  sim::Conditions conditions_;
};

/// The first places, with so many framesets each.
Result<Scene> make_scene(const firmware::Config& config, int places = 1, int framesets = 1);

}  // namespace bevloc::bench
