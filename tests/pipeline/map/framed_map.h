// Compact maps of version 1 with any body.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/crc32.h"
#include "pipeline/map/map_binary.h"

namespace bevloc::test {

/// A file with this body and a right header and CRC.
inline std::string framed_map(std::string_view body) {
  std::string file(kMapMagic);
  const auto append = [&file](uint32_t value, int count) {
    for (int i = 0; i < count; ++i) file.push_back(static_cast<char>(value >> (8 * i)));
  };
  constexpr uint32_t kVersion = 1;
  append(kVersion, 2);
  append(static_cast<uint32_t>(body.size()), 4);
  file += body;
  append(crc32(file), 4);
  return file;
}

}  // namespace bevloc::test
