#include "firmware/config/manifest.h"

#include <algorithm>
#include <array>
#include <utility>

#include "common/files.h"
#include "common/sha256.h"

namespace bevloc::firmware {
namespace {

constexpr size_t kDigits = 64;
constexpr size_t kMostShown = 80;  ///< characters of a wrong line

bool is_checksum(std::string_view text) {
  return text.size() == kDigits && text.find_first_not_of("0123456789abcdef") == text.npos;
}

/// Removes the first line from the text and returns it.
std::string_view take_line(std::string_view& text) {
  const size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code missing;
  return std::filesystem::equivalent(a, b, missing) && !missing;
}

}  // namespace

Result<std::vector<ManifestEntry>> parse_manifest(std::string_view text, const std::string& name) {
  std::vector<ManifestEntry> entries;
  for (int number = 1; !text.empty(); ++number) {
    const std::string_view line = take_line(text);
    if (line.empty() || line.starts_with('#')) continue;
    const std::string_view rest = line.substr(std::min(kDigits, line.size()));
    const bool has_file = rest.size() > 2 && (rest.starts_with("  ") || rest.starts_with(" *"));
    if (!has_file || !is_checksum(line.substr(0, kDigits))) {
      // A line of a wrong file may be megabytes long, so only its beginning is shown.
      return fail("{}:{}: found \"{}\", wanted a checksum and a file, as sha256sum writes them",
                  name, number, line.substr(0, kMostShown));
    }
    entries.push_back({rest.substr(2), std::string(line.substr(0, kDigits)), number});
  }
  if (entries.empty()) return fail("{}: found no checksum, wanted those of all files", name);
  return entries;
}

Status check_manifest(const std::filesystem::path& manifest,
                      std::span<const std::filesystem::path> used) {
  const auto entries = parse_file(manifest, parse_manifest);
  if (!entries) return tl::unexpected(entries.error());
  const std::filesystem::path folder = manifest.parent_path();
  for (const ManifestEntry& entry : *entries) {
    const Result<std::string> bytes = read_file(folder / entry.file);
    if (!bytes) return fail("{}:{}: {}", manifest.string(), entry.line, bytes.error().message);
    const std::string found = sha256_hex(*bytes);
    if (found == entry.sha256) continue;
    return fail("{}:{}: {}: found SHA-256 {}, wanted {}; install the right file or a new manifest",
                manifest.string(), entry.line, (folder / entry.file).string(), found, entry.sha256);
  }
  for (const std::filesystem::path& file : used) {
    const auto is_listed = [&](const ManifestEntry& entry) {
      return is_same_file(folder / entry.file, file);
    };
    if (file.empty() || std::ranges::any_of(*entries, is_listed)) continue;
    return fail(
        "{}: found no checksum of {}, wanted those of configuration, rig, model, map and the "
        "vehicle's DBC file",
        manifest.string(), file.string());
  }
  return {};
}

Status check_manifest_of(const Config& config) {
  const std::filesystem::path& manifest = config.manifest_file;
  if (manifest.empty()) return {};
  const auto now = read_file(manifest);
  const auto kept = config.kept_files.bytes_of(manifest);
  if (now && kept && *now != *kept) {
    return fail(
        "{}: found a manifest that has changed since bevlocd read it, wanted the same one; restart "
        "bevlocd, so that it reads all files again",
        manifest.string());
  }
  const std::array used{config.file, config.rig_file, config.model_file, config.map_file,
                        config.can.dbc_file};
  return check_manifest(manifest, used);
}

}  // namespace bevloc::firmware
