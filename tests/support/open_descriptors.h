// Counts the open file descriptors of the process, so that a test can detect a leak.
#pragma once

#include <filesystem>
#include <iterator>

namespace bevloc::test {

inline int open_descriptors() {
  const std::filesystem::directory_iterator descriptors("/proc/self/fd");
  return static_cast<int>(std::distance(begin(descriptors), end(descriptors)));
}

}  // namespace bevloc::test
