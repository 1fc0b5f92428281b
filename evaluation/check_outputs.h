// Keeps the commands from writing over the files that they read, and from writing a file twice.
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

#include "common/output_file.h"

namespace bevloc::evaluation {

/// Fails if one of the files `outs` is one of the files `inputs` or another one of `outs`, even
/// under another name. Ignores empty names. Devices, such as /dev/null, may be named twice.
inline Status check_outputs(const std::vector<std::filesystem::path>& outs,
                            const std::vector<std::filesystem::path>& inputs) {
  for (auto out = outs.begin(); out != outs.end(); ++out) {
    if (Status other = check_output(*out, inputs); !other) return other;
    const auto is_same = [out](const auto& earlier) { return name_same_file(earlier, *out); };
    if (check_file_or_none(*out) && std::any_of(outs.begin(), out, is_same)) {
      return fail("{}: found one name for two files to write, wanted two names", out->string());
    }
  }
  return {};
}

}  // namespace bevloc::evaluation
