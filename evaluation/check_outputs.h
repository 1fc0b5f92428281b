// Keeps the commands from writing over the files that they read.
#pragma once

#include <filesystem>
#include <vector>

#include "common/output_file.h"

namespace bevloc::evaluation {

/// Fails if one of the files `outs` is one of the files `inputs`, even under another name. Ignores
/// empty names.
inline Status check_outputs(const std::vector<std::filesystem::path>& outs,
                            const std::vector<std::filesystem::path>& inputs) {
  for (const std::filesystem::path& out : outs) {
    if (Status other = check_output(out, inputs); !other) return other;
  }
  return {};
}

}  // namespace bevloc::evaluation
