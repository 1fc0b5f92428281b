#include "training/native/record_output.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include <unistd.h>

namespace bevloc {

bool output_is_pipe(const std::string& program) {
  if (::isatty(STDOUT_FILENO) == 0) return true;
  std::fprintf(stderr, "%s: standard output is a terminal, wanted a pipe or a file\n",
               program.c_str());
  return false;
}

bool write_output(std::span<const uint8_t> bytes, const std::string& program) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      std::fprintf(stderr, "%s: standard output: %s\n", program.c_str(), std::strerror(errno));
      return false;
    }
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
  return true;
}

}  // namespace bevloc
