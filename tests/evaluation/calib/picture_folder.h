// A picture folder without pictures.
#pragma once

#include <filesystem>
#include <fstream>
#include <utility>

namespace bevloc::test {

/// Writes a folder of one second in which front and back send `rate_hz` frames each, the back
/// camera 4 ms later. The files of the pictures are empty.
inline void write_picture_folder(const std::filesystem::path& folder, int rate_hz) {
  for (const auto& [camera, offset_ms] : {std::pair("front", 0), std::pair("back", 4)}) {
    const std::filesystem::path path = folder / camera;
    std::filesystem::create_directory(path);
    std::ofstream(path / "picture.png");
    std::ofstream index(path / "frames.txt");
    for (int i = 0; i < rate_hz; ++i) {
      index << i << ' ' << 1'000'000'000LL * i / rate_hz + 1'000'000LL * offset_ms
            << " picture.png\n";
    }
  }
  std::ofstream(folder / "reference.csv") << "time_ns,x_m,y_m,yaw_deg\n0,0,0,0\n"
                                             "100000000,1,0,0\n2000000000,20,0,0\n";
}

}  // namespace bevloc::test
