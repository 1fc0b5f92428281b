// Pseudo-random inputs for the test models, equal to those of fixture_models/pseudo_random.py, and
// the files of the models.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "common/files.h"
#include "pipeline/network/view/view_table.h"

namespace bevloc::test {

/// A pseudo-random number that depends on `i` and `seed`.
inline uint32_t hashed(uint32_t i, uint32_t seed) {
  uint32_t x = i * 2654435761U + seed * 40503U;
  x ^= x >> 15;
  x *= 2246822519U;
  return x ^ (x >> 13);
}

/// Fills an input with pseudo-random elements. For the same seed, an int8 element is the uint8
/// element minus 128.
inline void fill_input(std::span<uint8_t> input, uint32_t seed) {
  for (size_t i = 0; i < input.size(); ++i) {
    input[i] = static_cast<uint8_t>(hashed(static_cast<uint32_t>(i), seed) >> 24);
  }
}

inline void fill_input(std::span<int8_t> input, uint32_t seed) {
  for (size_t i = 0; i < input.size(); ++i) {
    input[i] = static_cast<int8_t>((hashed(static_cast<uint32_t>(i), seed) >> 24) - 128);
  }
}

/// A pseudo-random table for `cells` BEV cells whose entries point to `keys` features. About 1/5 of
/// the weights, and all weights of the last cell, are 0.
inline ViewTable view_table(int cells, int keys) {
  ViewTable table;
  for (int i = 0; i < kViewSlots * cells; ++i) {
    const uint32_t h = hashed(static_cast<uint32_t>(i), 77);
    const bool unused = h % 5 == 0 || i % cells == cells - 1;
    table.index.push_back(static_cast<int32_t>(h % static_cast<uint32_t>(keys)));
    table.weight.push_back(unused ? 0.0F : static_cast<float>((h >> 8) & 127) / 1024.0F);
  }
  return table;
}

/// A pseudo-random table for the grid and the cameras of a whole network.
inline ViewTable network_view_table() {
  return view_table(kFeatureGrid.cells(), kCameraCount * kImageFeatureCells);
}

/// The path of a file in fixtures/.
inline std::string fixture(const std::string& file) {
  return std::string(BEVLOC_SOURCE_DIR "/tests/pipeline/network/fixtures/") + file;
}

inline std::string read_bytes(const std::string& path) {
  return read_file(path).value();
}

/// The outputs that numpy computed for a model.
inline std::vector<float> expected_values(const std::string& model) {
  const std::string bytes = read_bytes(fixture(model + ".expected"));
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

}  // namespace bevloc::test
