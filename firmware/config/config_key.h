// Errors that name the key of the configuration.
#pragma once

#include <string_view>

#include "common/result.h"

namespace bevloc::firmware {

/// Puts `key` before the error of what that key names, so that the reader finds the line to change:
/// "calibration.rig: rig.yaml: cannot be read (...)".
template <typename T>
Result<T> at_key(std::string_view key, Result<T> result) {
  return std::move(result).map_error(
      [key](const Error& error) { return Error{fmt::format("{}: {}", key, error.message)}; });
}

}  // namespace bevloc::firmware
