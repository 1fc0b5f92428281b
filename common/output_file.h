// Writes the files that options name. Its checks keep commands from writing over the files that
// they read, and from running long before they find out that they cannot write their result.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <unistd.h>

#include "common/files.h"
#include "common/result.h"
#include "common/writable_folder.h"

namespace bevloc {

/// Fails if `out` is one of the files `inputs`, even under another name. Ignores empty names.
inline Status check_output(const std::filesystem::path& out,
                           const std::vector<std::filesystem::path>& inputs) {
  for (const std::filesystem::path& in : inputs) {
    std::error_code missing;
    if (!std::filesystem::equivalent(in, out, missing)) continue;
    return fail("{}: found a file to write that is also read, wanted another name for the output",
                out.string());
  }
  return {};
}

/// Fails if this user cannot create or replace the file `out`. Ignores an empty name.
inline Status check_writable(const std::filesystem::path& out) {
  namespace fs = std::filesystem;
  if (out.empty()) return {};
  std::error_code error;
  if (fs::is_directory(out, error)) {
    return fail("{}: found a folder, wanted the name of a file to write", out.string());
  }
  const fs::path folder = out.has_parent_path() ? out.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) {
    return fail("{}: found no folder {}, wanted one for this file; create it first", out.string(),
                folder.string());
  }
  // A file that exists is written in place. It may be writable although none can be created in its
  // folder, such as /dev/null.
  if (fs::exists(out, error)) {
    if (access(out.c_str(), W_OK) == 0) return {};
    return fail("{}: found a file that this user may not write, wanted another name, or `chmod +w`",
                out.string());
  }
  if (const std::error_code refused = cannot_write_in(folder)) {
    return fail("{}: found no way to write in the folder {} ({}), wanted a folder that allows it",
                out.string(), folder.string(), refused.message());
  }
  return {};
}

/// Fails if the name of a file to write does not end in the extension `wanted`, such as ".png".
inline Status check_extension(const std::filesystem::path& out, std::string_view wanted) {
  const std::string found = out.extension().string();
  if (found == wanted) return {};
  return fail("{}: found the extension \"{}\" of a file to write, wanted {}", out.string(), found,
              wanted);
}

/// Writes the file that an option such as --json names. Does nothing if `out` is empty, which means
/// that the option is not given.
inline Status write_option_file(const std::filesystem::path& out, std::string_view bytes) {
  return out.empty() ? Status() : write_file(out, bytes);
}

}  // namespace bevloc
