// Reads and writes whole files.
#pragma once

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>

#include "common/result.h"

namespace bevloc {

/// Returns the bytes of a file.
inline Result<std::string> read_file(const std::filesystem::path& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  // Copying an empty file would set the output's failbit. Peeking into a directory sets badbit.
  if (file && file.peek() != std::ifstream::traits_type::eof()) bytes << file.rdbuf();
  if (!file.is_open() || file.bad()) {
    return fail("{}: found no readable file ({}), wanted one", path.string(), std::strerror(errno));
  }
  return bytes.str();
}

/// Reads a file and returns what `parse` makes of it. `parse` gets the text and the file's name for
/// messages, and returns a Result.
template <typename Parse>
auto parse_file(const std::filesystem::path& path, Parse parse)
    -> decltype(parse(std::string(), std::string())) {
  const Result<std::string> text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  return parse(*text, path.string());
}

/// Creates or replaces a file.
inline Status write_file(const std::filesystem::path& path, std::string_view bytes) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) {
    return fail("{}: cannot write {} bytes to this file ({})", path.string(), bytes.size(),
                std::strerror(errno));
  }
  return {};
}

/// Creates a folder with its parents. A folder that exists already is no error.
inline Status create_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error) return {};
  return fail("{}: found no way to create this folder ({}), wanted a folder to write to",
              folder.string(), error.message());
}

}  // namespace bevloc
