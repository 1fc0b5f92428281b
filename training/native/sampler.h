// C interface to the simulator's samples and to the daemon's view table, for training. Used by
// training/data.py.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bevloc_sampler bevloc_sampler;

/// Starts `threads` workers that render samples ahead; bevloc_sampler_destroy() stops and frees
/// them. Samples come in order, and sample i depends only on (first_seed, i), not on the number of
/// workers. `first_sample` resumes a stream in its middle. `drop_camera_probability`: probability
/// that a sample lacks one or two cameras (their images are black). `nuisances`: 0 usual, 1 strong,
/// 2 street (sim/samples/training_nuisances.h). `photos`: a folder of script/photos, or null for
/// the simulator's own textures. Returns null if the photographs cannot be read, and writes the
/// reason to stderr.
bevloc_sampler* bevloc_sampler_create(uint64_t first_seed, uint64_t first_sample, int threads,
                                      double drop_camera_probability, int nuisances,
                                      const char* photos);
void bevloc_sampler_destroy(bevloc_sampler* sampler);

/// Writes the next `count` samples and blocks until they are rendered. Only one thread may call it.
///   images          uint8 [count, 6, 3, 96, 320]  RGB planes of the network cameras
///   camera_mask     uint8 [count]                 bit i: camera i is present
///   raster_prior    uint8 [count, 3, 400, 200]    the map drawn at T0, the network's input
///   raster_truth    uint8 [count, 3, 400, 200]    the map drawn at T, the target of segmentation
///   correction      float [count, 3]              dT = T0^-1 T: x m, y m, yaw rad
///   motions         float [count, 6, 3]           reference_from_exposure of each camera
///                                                 (pipeline/calibration/rig.h): x m, y m, yaw rad
///   rig             float [count, 6, 15]          the network cameras: focal length, principal
///                                                 column and row in pixels, then the rotation (row
///                                                 by row) and the translation of
///                                                 vehicle_from_camera
/// dT is uniform in +-2 m, +-1 m, +-2 degrees. All motions of a sample are zero if its cameras
/// expose at the same time.
void bevloc_sampler_next(bevloc_sampler* sampler, int count, uint8_t* images, uint8_t* camera_mask,
                         uint8_t* raster_prior, uint8_t* raster_truth, float* correction,
                         float* motions, float* rig);

/// Writes the view table (pipeline/network/view/view_table.h) for the cameras in `camera_mask`:
/// index int32 [8, 5000], weight float [8, 5000]. `motions`: a sample's [6, 3], or null for cameras
/// that expose at the same time. `rig`: a sample's [6, 15], or null for the simulator's own.
void bevloc_view_table(uint8_t camera_mask, int32_t* index, float* weight, const float* motions,
                       const float* rig);

#ifdef __cplusplus
}
#endif
