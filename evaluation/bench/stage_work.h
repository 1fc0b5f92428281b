// The work of each stage in one frame: bytes touched, and multiply-accumulates of the network.
#pragma once

#include "common/image_view.h"
#include "evaluation/bench/camera_formats.h"
#include "evaluation/bench/cost_model.h"
#include "evaluation/bench/scene.h"
#include "pipeline/map/map_index.h"
#include "pipeline/network/model/network_cost.h"

namespace bevloc::bench {

/// The image rows that the network cameras read, the remap tables, and the planes written.
Work image_path_work(const Rig& rig, PixelFormat format);

/// The JPEG files read and the planes written.
Work decode_work(const Rig& rig, const ConvertedImages& files);

/// The map segments found around the places (mean), and the raster written.
Work map_raster_work(const Scene& scene, const MapIndex& index);
/// The map segments alone.
Work map_crop_work(const Scene& scene, const MapIndex& index);

/// The features of images and map.
Work solver_work();

Work view_table_work();
Work network_work(const BranchCost& cost);

/// The axis-aligned box in the map that contains the raster around a pose.
struct Surroundings {
  Eigen::Vector2d min_corner;
  Eigen::Vector2d max_corner;
};
Surroundings surroundings_of(const Se2& map_from_vehicle);

}  // namespace bevloc::bench
