// The CRC-32 of IEEE 802.3, zip and PNG: polynomial 0x04C11DB7, reflected.
#pragma once

#include <cstdint>
#include <string_view>

namespace bevloc {

uint32_t crc32(std::string_view bytes);

}  // namespace bevloc
