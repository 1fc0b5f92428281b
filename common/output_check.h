// Keeps commands from writing over the files that they read.
#pragma once

#include <filesystem>
#include <initializer_list>

#include "common/result.h"

namespace bevloc {

/// Fails if `out` is one of the files `inputs`, even under another name. Ignores empty names.
inline Status check_output(const std::filesystem::path& out,
                           std::initializer_list<std::filesystem::path> inputs) {
  for (const std::filesystem::path& in : inputs) {
    std::error_code missing;
    if (!std::filesystem::equivalent(in, out, missing)) continue;
    return fail("{}: found a file to write that is also read, wanted another name for the output",
                out.string());
  }
  return {};
}

/// Fails if a file to write has another extension (".png").
inline Status check_extension(const std::filesystem::path& out, std::string_view wanted) {
  const std::string found = out.extension().string();
  if (found == wanted) return {};
  return fail("{}: found the extension \"{}\" of a file to write, wanted {}", out.string(), found,
              wanted);
}

}  // namespace bevloc
