// Reads the key of the authentication, and counts the starts in a file.
#pragma once

#include <cstdint>
#include <filesystem>

#include "can/secoc/cmac.h"

namespace bevloc::can {

/// Reads 32 hexadecimal digits. Refuses a file that group or others may read or write.
Result<SecocKey> read_secoc_key(const std::filesystem::path& file);

/// Reads the number of starts so far. Returns 0 if there is no file. Refuses a file with anything
/// but one number that can be counted up.
Result<uint32_t> read_start_number(const std::filesystem::path& file);

/// Counts this start, and returns the number in the file plus one, or 1 if there is no file.
/// Returns only after file and folder are on the disk, so a power cut does not restore an earlier
/// number. Fails if the number cannot be stored, because freshness values would repeat.
Result<uint32_t> next_start_number(const std::filesystem::path& file);

}  // namespace bevloc::can
