// The input of the bench: places of a simulated world and the images taken there.
#pragma once

#include <array>
#include <vector>

#include "common/image.h"
#include "common/result.h"
#include "common/se2.h"
#include "evaluation/drive/drive_config.h"
#include "pipeline/calibration/rig.h"
#include "pipeline/map/hd_map.h"
#include "sim/render/renderer.h"
#include "sim/world/world.h"

namespace bevloc::bench {

/// The images of one frameset, by camera.
using FramesetImages = std::array<RgbImage, kCameraCount>;

/// A place on a road where the vehicle stands.
struct Place {
  Se2 map_from_vehicle;
  std::vector<FramesetImages> framesets;  ///< consecutive; traffic and noise differ
};

struct Scene {
  Rig rig;
  HdMap map;
  std::vector<Place> places;

  /// Memory of all images.
  double images_mib() const;
};

/// Renders the configuration's world with its rig.
class SceneDrawer {
 public:
  /// Fails if map or rig cannot be read, or if the map has no lanes.
  static Result<SceneDrawer> create(const evaluation::DriveConfig& config);

  const Rig& rig() const { return rig_; }
  const HdMap& map() const { return world_.map; }

  /// The same number gives the same place. Only evaluations use these places.
  Place draw(int number, int framesets) const;

 private:
  SceneDrawer(const Rig& rig, sim::World world, const sim::Conditions& conditions);

  Rig rig_;
  sim::World world_;
  sim::Conditions conditions_;
};

/// Makes a scene of the first `places` places with `framesets` framesets each. Fails as
/// SceneDrawer::create() does.
Result<Scene> make_scene(const evaluation::DriveConfig& config, int places = 1, int framesets = 1);

}  // namespace bevloc::bench
