#include "pipeline/online_calibration/calibration_file.h"

#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/crc32.h"
#include "common/files.h"
#include "common/replace_file.h"
#include "common/strict_yaml.h"
#include "pipeline/calibration/rig_yaml.h"

namespace bevloc {
namespace {

constexpr int kFormat = 1;
constexpr std::string_view kChecksumKey = "crc32: ";
constexpr size_t kTriangle = static_cast<size_t>(kExtrinsicErrors) * (kExtrinsicErrors + 1) / 2;

std::string list_of(const std::vector<double>& numbers) {
  return fmt::format("[{:.17g}]", fmt::join(numbers, ", "));
}

}  // namespace

uint32_t rig_crc32(const Rig& rig) {
  return crc32(format_rig(rig));
}

std::string format_learned(const LearnedCalibration& learned) {
  std::vector<double> errors(learned.errors.begin(), learned.errors.end());
  std::vector<double> covariance;
  for (int row = 0; row < kExtrinsicErrors; ++row) {
    for (int col = 0; col <= row; ++col) covariance.push_back(learned.covariance(row, col));
  }
  const std::string text = fmt::format(
      "# What bevlocd learned about its calibration. Delete this file to start again.\n"
      "format: {}\nrig_crc32: {}\nerrors: {}\ncovariance: {}\n",
      kFormat, learned.rig_crc32, list_of(errors), list_of(covariance));
  return fmt::format("{}{}{}\n", text, kChecksumKey, crc32(text));
}

Result<LearnedCalibration> parse_learned(const std::string& text, const std::string& name) {
  auto yaml = YamlMap::parse(text, name);
  if (!yaml) return tl::unexpected(yaml.error());
  LearnedCalibration learned;
  yaml->require<int>("format", between(kFormat, kFormat));
  learned.rig_crc32 = yaml->require<uint32_t>("rig_crc32");
  const auto errors = yaml->require_list<double>("errors", kExtrinsicErrors);
  const auto covariance = yaml->require_list<double>("covariance", kTriangle);
  const auto checksum = yaml->require<uint32_t>("crc32");
  const size_t end = text.rfind(kChecksumKey);
  if (end != std::string::npos && crc32(std::string_view(text).substr(0, end)) != checksum) {
    yaml->reject("crc32", "content that does not fit this checksum",
                 "the file as bevlocd wrote it");
  }
  if (Status status = yaml->finish(); !status) return tl::unexpected(status.error());
  learned.errors = ExtrinsicErrors(errors.data());
  size_t next = 0;
  for (int row = 0; row < kExtrinsicErrors; ++row) {
    for (int col = 0; col <= row; ++col) {
      learned.covariance(row, col) = covariance[next];
      learned.covariance(col, row) = covariance[next++];
    }
  }
  return learned;
}

Status save_learned(const LearnedCalibration& learned, const std::filesystem::path& path) {
  return replace_file(path, format_learned(learned));
}

Result<LearnedCalibration> load_learned(const std::filesystem::path& path, uint32_t rig_crc32) {
  auto learned = parse_file(path, parse_learned);
  if (learned && learned->rig_crc32 != rig_crc32) {
    return fail(
        "{}: found errors that were learned for another rig ({:08x}), wanted {:08x}; this file is "
        "not used, and will be replaced",
        path.string(), learned->rig_crc32, rig_crc32);
  }
  return learned;
}

}  // namespace bevloc
