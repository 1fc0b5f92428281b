// Checks whether files can be created in a folder, without creating any.
#pragma once

#include <cerrno>
#include <filesystem>
#include <system_error>

#include <unistd.h>

namespace bevloc {

/// The folder of a file. A bare name lies in the current folder.
inline std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

/// Returns why this user cannot create files in `folder`, or no error if it can. If the folder is
/// missing, checks its nearest parent that exists instead.
inline std::error_code cannot_write_in(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::path there = fs::absolute(folder, error).lexically_normal();
  while (!fs::exists(fs::symlink_status(there, error)) && there.has_relative_path()) {
    there = there.parent_path();
  }
  if (!fs::is_directory(there, error)) return std::make_error_code(std::errc::not_a_directory);
  if (access(there.c_str(), W_OK | X_OK) == 0) return {};
  return {errno, std::generic_category()};
}

}  // namespace bevloc
