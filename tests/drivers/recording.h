// Writes small recordings for tests into a temporary folder.
#pragma once

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "common/image_file.h"

namespace bevloc::drivers {

/// The destructor removes the folder.
class Recording {
 public:
  Recording() {
    std::string name =
        (std::filesystem::temp_directory_path() / "bevloc-recording-XXXXXX").string();
    directory_ = mkdtemp(name.data());
  }
  ~Recording() {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  const std::filesystem::path& directory() const { return directory_; }

  /// Writes an image of one colour (red, green, blue).
  void add_image(const std::string& name, int width, int height, std::array<uint8_t, 3> rgb) const {
    RgbImage image(width, height);
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = rgb[i % 3];
    EXPECT_TRUE(write_png(image.view(), (directory_ / name).string()));
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name) << text;
  }

 private:
  std::filesystem::path directory_;
};

}  // namespace bevloc::drivers
