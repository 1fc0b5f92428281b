// SHA-256 checksums (FIPS 180-4).
#pragma once

#include <string>
#include <string_view>

namespace bevloc {

/// The checksum in 64 lower-case hexadecimal digits, as sha256sum writes it.
std::string sha256_hex(std::string_view bytes);

}  // namespace bevloc
