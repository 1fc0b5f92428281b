// Reads the golden vectors that training writes (training/golden.py): numpy's .npy files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bevloc::test {

template <typename Element>
struct NpyArray {
  std::vector<size_t> shape;
  std::vector<Element> values;  ///< row-major

  /// Entry i of the first axis.
  std::vector<Element> entry(size_t i) const {
    const size_t size = values.size() / shape.at(0);
    return {values.begin() + i * size, values.begin() + (i + 1) * size};
  }
};

/// float16 and float32 elements. Throws std::runtime_error if the file is not such an array.
NpyArray<float> read_npy_floats(const std::string& path);

/// uint8 elements. Throws likewise.
NpyArray<uint8_t> read_npy_bytes(const std::string& path);

/// A path under tests/golden.
std::string golden(const std::string& file);

}  // namespace bevloc::test
