// How many bytes the stages outside the network touch in one frame.
#pragma once

#include "common/image_view.h"
#include "firmware/bench/camera_formats.h"
#include "firmware/bench/cost_model.h"
#include "firmware/bench/scene.h"
#include "pipeline/map/map_index.h"
#include "pipeline/network/network_cost.h"

namespace bevloc::bench {

/// The rows of the pictures that network cameras look at, the remap tables and the planes written.
Work image_path_work(const Rig& rig, PixelFormat format);

/// JPEG files read and their planes written.
Work decode_work(const Rig& rig, const CameraPictures& files);

/// The segments found around the places (their mean), and the raster written.
Work map_raster_work(const Scene& scene, const MapIndex& index);
Work map_crop_work(const Scene& scene, const MapIndex& index);

/// The features of both sides.
Work solver_work();

Work view_table_work();
Work network_work(const BranchCost& cost);

/// The corners of the box that holds the raster around a pose, however it is turned.
struct Surroundings {
  Eigen::Vector2d min_corner;
  Eigen::Vector2d max_corner;
};
Surroundings surroundings_of(const Se2& map_from_vehicle);

}  // namespace bevloc::bench
