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
#include "common/replace_file.h"
#include "common/result.h"
#include "common/writable_folder.h"

namespace bevloc {

/// Returns whether these are two names of one file, which need not exist. An empty name is none.
inline bool name_same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  namespace fs = std::filesystem;
  if (a.empty() || b.empty()) return false;
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  const fs::path real = fs::weakly_canonical(fs::absolute(a, error), error);
  return !real.empty() && real == fs::weakly_canonical(fs::absolute(b, error), error);
}

/// Fails if `out` is one of the files `inputs`, even under another name. Ignores empty names.
inline Status check_output(const std::filesystem::path& out,
                           const std::vector<std::filesystem::path>& inputs) {
  for (const std::filesystem::path& in : inputs) {
    if (!name_same_file(in, out)) continue;
    return fail("{}: found a file to write that is also read, wanted another name for the output",
                out.string());
  }
  return {};
}

/// Fails if the folder of the file `out` is missing.
inline Status check_has_folder(const std::filesystem::path& out) {
  std::error_code error;
  const std::filesystem::path folder = folder_of(out);
  if (std::filesystem::is_directory(folder, error)) return {};
  return fail("{}: found no folder {}, wanted one for this file; create it first", out.string(),
              folder.string());
}

/// Fails if this user cannot create files in the folder of `out`.
inline Status check_can_create(const std::filesystem::path& out) {
  const std::filesystem::path folder = folder_of(out);
  const std::error_code refused = cannot_write_in(folder);
  if (!refused) return {};
  return fail("{}: found no way to write in the folder {} ({}), wanted a folder that allows it",
              out.string(), folder.string(), refused.message());
}

/// Fails if this user cannot create the file `out` or write it in place. Ignores an empty name.
inline Status check_writable(const std::filesystem::path& out) {
  namespace fs = std::filesystem;
  if (out.empty()) return {};
  std::error_code error;
  if (fs::is_directory(out, error)) {
    return fail("{}: found a folder, wanted the name of a file to write", out.string());
  }
  if (Status folder = check_has_folder(out); !folder) return folder;
  // A file that exists is written in place. It may be writable although none can be created in its
  // folder, such as /dev/null.
  if (fs::exists(out, error)) {
    if (access(out.c_str(), W_OK) == 0) return {};
    return fail("{}: found a file that this user may not write, wanted another name, or `chmod +w`",
                out.string());
  }
  return check_can_create(out);
}

/// Fails if this user cannot create the file `out` or replace it by a new one (replace_file()). For
/// a new file the folder must be writable, the file itself need not be.
inline Status check_replaceable(const std::filesystem::path& out) {
  if (Status file = check_file_or_none(out); !file) return file;
  if (Status folder = check_has_folder(out); !folder) return folder;
  return check_can_create(out);
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
