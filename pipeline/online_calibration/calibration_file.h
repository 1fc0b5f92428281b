// Keeps what the online calibration learned across restarts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/result.h"
#include "pipeline/online_calibration/extrinsic_errors.h"

namespace bevloc {

/// An estimate, and the rig that it belongs to.
struct LearnedCalibration {
  uint32_t rig_crc32 = 0;  ///< CRC-32 of the rig as format_rig() writes it
  ExtrinsicErrors errors = ExtrinsicErrors::Zero();
  ExtrinsicCovariance covariance = ExtrinsicCovariance::Zero();

  bool operator==(const LearnedCalibration&) const = default;
};

/// A number that identifies a rig. What was learned about one rig is wrong for another.
uint32_t rig_crc32(const Rig& rig);

/// The text of a file: a YAML mapping, which ends with a CRC-32 of all text before it.
std::string format_learned(const LearnedCalibration& learned);

/// Fails with file and key on a damaged or cut text, an unknown key, or a number that is not
/// finite.
Result<LearnedCalibration> parse_learned(const std::string& text, const std::string& name);

/// Replaces the file in one step. After a power failure it has the old or the new content.
Status save_learned(const LearnedCalibration& learned, const std::filesystem::path& path);

/// Fails as parse_learned() does, and if the file belongs to another rig.
Result<LearnedCalibration> load_learned(const std::filesystem::path& path, uint32_t rig_crc32);

}  // namespace bevloc
