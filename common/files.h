// Whole files in and out.
#pragma once

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

#include "common/result.h"

namespace bevloc {

/// The bytes of a file.
inline Result<std::string> read_file(const std::filesystem::path& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  // An empty file sets the output's failbit, a directory the input's badbit.
  if (file && file.peek() != std::ifstream::traits_type::eof()) bytes << file.rdbuf();
  if (!file.is_open() || file.bad()) {
    return fail("{}: found no readable file ({}), wanted one", path.string(), std::strerror(errno));
  }
  return bytes.str();
}

/// Creates or replaces a file.
inline Status write_file(const std::filesystem::path& path, std::string_view bytes) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) {
    return fail("{}: found no way to write this file ({}), wanted to write {} bytes", path.string(),
                std::strerror(errno), bytes.size());
  }
  return {};
}

}  // namespace bevloc
