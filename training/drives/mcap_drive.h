// A drive in the MCAP files of the recorder.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "evaluation/recording/recording.h"
#include "training/drives/recorded_drive.h"

namespace bevloc::drives {

/// Where the reference poses of a recording come from.
enum class ReferenceKind : uint8_t {
  kFile,   ///< reference.csv beside the files
  kOwn,    ///< what the appliance sent where it was sure (own_track())
  kTruth,  ///< the recorded truth of a simulated drive
};

class McapDrive final : public RecordedDrive {
 public:
  /// `files`: of one run. `rig`: instead of the recorded one, which is corrected by what the
  /// appliance had learned about it. The times of reference.csv are nanoseconds since 1970, as the
  /// times of the files.
  static Result<std::unique_ptr<RecordedDrive>> open(
      const std::vector<std::filesystem::path>& files, ReferenceKind kind,
      const std::optional<Rig>& rig);

  Result<Time> read(const FramesetPlace& frameset, int camera, ImagePreprocessor& preprocessor,
                    std::span<int8_t> planes) override;

 private:
  McapDrive(DriveIndex index, evaluation::Recording recording)
      : RecordedDrive(std::move(index)), recording_(std::move(recording)) {}

  evaluation::Recording recording_;
};

}  // namespace bevloc::drives
