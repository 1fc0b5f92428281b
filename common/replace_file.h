// Replaces files so that a crash leaves either the old or the new content.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/result.h"

namespace bevloc {

/// Fails if `path` exists and is not a file. A new file must not take the place of a device, such
/// as /dev/stdout.
Status check_file_or_none(const std::filesystem::path& path);

/// Writes a new file beside `path`, flushes it to the disk and renames it over `path`. The new file
/// gets the mode of the earlier one. It also gets the owner and group, if this user may set them.
/// Fails if `path` exists and is not a file.
Status replace_file(const std::filesystem::path& path, std::string_view bytes);

/// Like replace_file(), but first keeps the earlier file under the first free name of PATH.bak,
/// PATH.bak2 and so on, with the same mode and owner. If there is no earlier file, it makes no
/// backup.
Status replace_file_with_backup(const std::filesystem::path& path, std::string_view bytes);

}  // namespace bevloc
