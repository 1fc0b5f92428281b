// The binary form in which samples go to training (training/sampler_process.py): simulated ones
// from bevloc_sampler, recorded ones from bevloc_drive_sampler.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/cameras.h"
#include "common/se2.h"
#include "pipeline/network/view/view_table.h"

namespace bevloc {

/// Begins a stream of records; all numbers are little-endian.
///   char[8]       "bevlocS1"
///   uint32[8]     cameras, image rows, image columns; raster channels, rows, columns; slots and
///                 cells of the view table
/// Records of one size follow, without end:
///   images        uint8 [6, 3, 96, 320]  RGB planes of the network cameras
///   raster_prior  uint8 [3, 400, 200]    the map drawn at T0, the network's input
///   raster_truth  uint8 [3, 400, 200]    the map drawn at T, the target of segmentation
///   index         int32 [8, 5000]        the view table of the sample's cameras
///   weight        float [8, 5000]        (pipeline/network/view/view_table.h)
///   correction    float [3]              dT = T0^-1 T: x m, y m, yaw rad
///   camera_mask   uint32                 bit i: camera i is present
/// A record of zeros, which has no camera, stands for a bad sample (--blank-bad of
/// bevloc_drive_sampler).
std::vector<uint8_t> sample_stream_header();

/// The number of bytes of one record.
size_t sample_record_size();

/// What a record contains. It borrows its values.
struct SampleContent {
  std::span<const uint8_t> images;
  std::span<const uint8_t> raster_prior;
  std::span<const uint8_t> raster_truth;
  const ViewTable& table;
  Se2 correction;
  CameraMask cameras;
};

/// Writes the record of a sample; `record` gets sample_record_size() bytes.
void write_sample_record(const SampleContent& sample, std::vector<uint8_t>& record);

}  // namespace bevloc
