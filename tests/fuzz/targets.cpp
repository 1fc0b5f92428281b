#include "tests/fuzz/targets.h"

#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

namespace bevloc::fuzz {

void expect(bool condition, const char* message) {
  if (condition) return;
  std::fprintf(stderr, "fuzz: found %s\n", message);
  std::abort();
}

std::string path_of_file_with(Bytes bytes) {
  static const int file = memfd_create("fuzz", MFD_CLOEXEC);
  expect(file >= 0, "no memory for a file");
  const bool written = ftruncate(file, 0) == 0 && pwrite(file, bytes.data(), bytes.size(), 0) ==
                                                      static_cast<ssize_t>(bytes.size());
  expect(written, "no memory for the bytes of a file");
  return fmt::format("/proc/self/fd/{}", file);
}

}  // namespace bevloc::fuzz
