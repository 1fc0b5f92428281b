// The manifest: checksums of the files that an appliance may run with.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"
#include "firmware/config/config.h"

namespace bevloc::firmware {

/// A line of a manifest.
struct ManifestEntry {
  std::filesystem::path file;  ///< as the manifest writes it
  std::string sha256;          ///< 64 lower-case hexadecimal digits
  int line = 0;
};

/// Parses what `sha256sum FILE...` writes: 64 hexadecimal digits, two spaces (or one and a `*`),
/// and the file. Empty lines and lines that begin with `#` are ignored. Error messages show `name`.
Result<std::vector<ManifestEntry>> parse_manifest(std::string_view text, const std::string& name);

/// Reads the manifest, whose files are relative to its folder. Fails unless every file in it has
/// its checksum, and each of `used` is in it. Empty paths in `used` are ignored.
Status check_manifest(const std::filesystem::path& manifest,
                      std::span<const std::filesystem::path> used);

/// Checks the files of a configuration against the manifest that it names, if it names one. Fails
/// also if the manifest has changed since load_config() read it, because it then no longer says
/// whether the files in memory are the right ones.
Status check_manifest_of(const Config& config);

}  // namespace bevloc::firmware
