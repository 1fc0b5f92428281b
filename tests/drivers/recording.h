// Writes small recordings for tests into a temporary folder.
#pragma once

#include <array>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "common/image_file.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::drivers {

class Recording {
 public:
  const std::filesystem::path& directory() const { return folder_.path(); }

  /// Writes an image of one colour (red, green, blue).
  void add_image(const std::string& name, int width, int height, std::array<uint8_t, 3> rgb) const {
    RgbImage image(width, height);
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = rgb[i % 3];
    EXPECT_TRUE(write_png(image.view(), (folder_ / name).string()));
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

 private:
  test::TemporaryFolder folder_;
};

}  // namespace bevloc::drivers
