// Makes small recordings for the tests, in a folder that goes away with the object.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

namespace bevloc::drivers {

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

  /// A picture of one colour (red, green, blue).
  void add_picture(const std::string& name, int width, int height, cv::Vec3b rgb) const {
    const cv::Mat bgr(height, width, CV_8UC3, cv::Scalar(rgb[2], rgb[1], rgb[0]));
    cv::imwrite((directory_ / name).string(), bgr);
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name) << text;
  }

 private:
  std::filesystem::path directory_;
};

}  // namespace bevloc::drivers
