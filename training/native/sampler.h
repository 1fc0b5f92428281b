// C interface through which training reads samples from the simulator, and the reference tables
// that it must share with the daemon.
#pragma once

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bevloc_sampler bevloc_sampler;

/// Starts `threads` workers that render samples ahead. Sample i of a stream depends on (first_seed,
/// i) alone, whatever the number of workers, and samples come out in order. `first_sample` resumes
/// a stream in its middle. `drop_camera_probability`: chance that a sample lacks one or two cameras
/// (their images are black). `strong_nuisances`: other than 0 for more trouble than is usual
/// (sim/samples/training_nuisances.h).
bevloc_sampler* bevloc_sampler_create(uint64_t first_seed, uint64_t first_sample, int threads,
                                      double drop_camera_probability, int strong_nuisances);
void bevloc_sampler_destroy(bevloc_sampler* sampler);

/// Fills `count` samples:
///   images          uint8 [count, 6, 3, 96, 320]  RGB planes, through the network cameras
///   camera_mask     uint8 [count]                 bit i: camera i is there
///   raster_prior    uint8 [count, 3, 400, 200]    the map drawn at T0, the network's input
///   raster_truth    uint8 [count, 3, 400, 200]    the map drawn at T, the target of segmentation
///   correction      float [count, 3]              dT = T0^-1 T: x m, y m, yaw rad
///   motions         float [count, 6, 3]           reference_from_exposure of each camera
///                                                 (pipeline/calibration/rig.h): x m, y m, yaw rad
/// dT is uniform in +-2 m, +-1 m, +-2 degrees. All motions of a sample are zero if its cameras
/// expose at once.
void bevloc_sampler_next(bevloc_sampler* sampler, int count, uint8_t* images, uint8_t* camera_mask,
                         uint8_t* raster_prior, uint8_t* raster_truth, float* correction,
                         float* motions);

/// The view table (pipeline/network/view_table.h) of the rig that samples are rendered for, with
/// the cameras of `camera_mask`: index int32 [8, 5000], weight float [8, 5000]. `motions`: a
/// sample's [6, 3], or null for cameras that expose at once.
void bevloc_view_table(uint8_t camera_mask, int32_t* index, float* weight, const float* motions);

#ifdef __cplusplus
}
#endif
