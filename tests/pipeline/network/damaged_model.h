// A network file with damaged weights.
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "common/files.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::test {

/// Writes the shipped network with damaged bytes in its middle. It loads, and computes wrong
/// results.
inline std::filesystem::path damaged_model(const TemporaryFolder& folder) {
  std::string bytes = read_file(BEVLOC_SOURCE_DIR "/models/nano.onnx").value();
  for (size_t i = 0; i < 4096; ++i) {
    char& byte = bytes[bytes.size() / 2 + i];
    byte = static_cast<char>(byte ^ 0x20);
  }
  std::filesystem::path path = folder / "damaged.onnx";
  EXPECT_TRUE(write_file(path, bytes));
  return path;
}

}  // namespace bevloc::test
