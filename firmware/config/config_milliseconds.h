// Reads durations, which configuration files give in milliseconds.
#pragma once

#include <string_view>

#include "common/strict_yaml.h"
#include "common/time.h"

namespace bevloc::firmware {

inline Duration require_milliseconds(YamlMap& yaml, std::string_view key,
                                     const Wanted<double>& wanted) {
  return from_milliseconds(yaml.require<double>(key, wanted));
}

inline Duration optional_milliseconds(YamlMap& yaml, std::string_view key, Duration fallback,
                                      const Wanted<double>& wanted) {
  return from_milliseconds(yaml.optional<double>(key, to_milliseconds(fallback), wanted));
}

}  // namespace bevloc::firmware
