// The samples that training stores as golden vectors (training/golden.py), as network input.
#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "pipeline/network/network.h"
#include "pipeline/preprocessing/network_camera.h"
#include "sim/sim_rig.h"
#include "tests/support/npy.h"

namespace bevloc::test {

inline size_t golden_sample_count() {
  return read_npy_bytes(golden("network/cameras.npy")).values.size();
}

/// Sets the view table and both inputs of the network to those of a sample.
inline void set_golden_input(Network& network, size_t sample) {
  const auto cameras = read_npy_bytes(golden("network/cameras.npy"));
  const Rig rig = network_rig(sim::nominal_rig());
  network.set_view_table(make_view_table(rig, CameraMask(cameras.values.at(sample)), kFeatureGrid));
  const auto images = read_npy_bytes(golden("network/images.npy")).entry(sample);
  const auto raster = read_npy_bytes(golden("network/raster.npy")).entry(sample);
  if (images.size() != network.image_input().size() ||
      raster.size() != network.raster_input().size()) {
    throw std::runtime_error("golden samples: the size differs from that of the network's inputs");
  }
  std::ranges::transform(images, network.image_input().begin(), [](uint8_t value) {
    return static_cast<int8_t>(static_cast<int>(value) - 128);
  });
  std::ranges::copy(raster, network.raster_input().begin());
}

}  // namespace bevloc::test
