// Replaces files so that a crash leaves either the old or the new content.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/result.h"

namespace bevloc {

/// Writes a new file beside `path`, flushes it to the disk and renames it over `path`. Fails if
/// `path` is there and no file.
Status replace_file(const std::filesystem::path& path, std::string_view bytes);

/// The same, and keeps what was there before as PATH.bak, PATH.bak2 and so on: the first of these
/// names that is free. Without an earlier file there is no backup.
Status replace_file_with_backup(const std::filesystem::path& path, std::string_view bytes);

}  // namespace bevloc
