// Files that an integrator writes: configuration, rig and the index of a recording.
#include <filesystem>

#include "common/files.h"
#include "drivers/camera/replay/replay_camera.h"
#include "firmware/config/config.h"
#include "pipeline/calibration/import/import_rig.h"
#include "pipeline/calibration/reference_trajectory.h"
#include "pipeline/calibration/rig_check.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/preprocessing/network_camera.h"
#include "tests/fuzz/targets.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::fuzz {
namespace {

/// A folder with one file, which lies in memory, so that no input waits for a disk. A relative path
/// in the file leads to nothing else: beside the file in memory lie the open files of the fuzzer,
/// and reading one of its pipes would wait forever.
class FolderInMemory {
 public:
  explicit FolderInMemory(const char* name) : file_(folder_ / name) {
    std::filesystem::create_symlink(path_of_file_with({}), file_);
  }
  const std::filesystem::path& path() const { return folder_.path(); }
  const std::filesystem::path& file_with(Bytes bytes) const {
    (void)path_of_file_with(bytes);
    return file_;
  }

 private:
  const test::TemporaryFolder folder_;
  const std::filesystem::path file_;
};

}  // namespace

void run_config(Bytes bytes) {
  static const FolderInMemory folder("fuzz.yaml");
  const auto config = firmware::load_config(folder.file_with(bytes));
  if (!config) expect(!config.error().message.empty(), "an error without a message");
}

/// A calibration of another program, as any of the files that are recognised.
void run_calibration(Bytes bytes) {
  const std::string text(text_of(bytes));
  const ForeignFile sensors{"sensor.json",
                            R"([{"token": "s", "channel": "front", "modality": "camera"}])"};
  const ForeignFile cameras{"cameras.txt", "1 PINHOLE 640 360 500 500 320 180\n"};
  RigImportOptions options;
  options.vehicle_from = {{"imu", {}}, {"world", {}}};
  for (const auto& files : {std::vector<ForeignFile>{{"front.yaml", text}},
                            std::vector<ForeignFile>{{"a.json", text}, sensors},
                            std::vector<ForeignFile>{{"cameras.txt", text}},
                            std::vector<ForeignFile>{cameras, {"images.txt", text}}}) {
    const auto imported = import_rig(files, options);
    if (!imported) {
      expect(!imported.error().message.empty(), "an error without a message");
    } else {
      expect(!find_mistake(imported->rig), "an imported rig with a mistake");
    }
  }
  const auto places = parse_extrinsics(text, "fuzz.yaml");
  expect(places || !places.error().message.empty(), "an error without a message");
  const auto reference = ReferenceTrajectory::parse(text, "fuzz.csv");
  if (reference) expect(reference->poses().size() >= 2, "a reference without poses");
}

void run_rig(Bytes bytes) {
  const auto rig = parse_rig(std::string(text_of(bytes)), "fuzz.yaml");
  if (!rig) return;
  expect(!find_mistake(*rig), "a rig with a mistake");
  for (const CameraModel& camera : network_rig(*rig).cameras) {
    expect(camera.vehicle_from_camera.rotation.allFinite(), "a rotation that is not finite");
    expect(std::isfinite(camera.intrinsics.cy_px), "a network camera without a horizon");
  }
}

void run_frames_txt(Bytes bytes) {
  static const FolderInMemory folder("frames.txt");
  static const Status picture = write_file(folder.path() / "a.png", "");
  expect(picture.has_value(), "no place for a picture");
  (void)folder.file_with(bytes);
  const auto recording = drivers::load_recording(folder.path());
  if (!recording) return;
  expect(!recording->empty(), "a recording without frames");
  for (size_t i = 1; i < recording->size(); ++i) {
    const drivers::RecordedFrame& before = (*recording)[i - 1];
    const drivers::RecordedFrame& frame = (*recording)[i];
    expect(frame.sequence > before.sequence && frame.time > before.time, "frames out of order");
  }
}

}  // namespace bevloc::fuzz
