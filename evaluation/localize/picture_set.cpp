#include "evaluation/localize/picture_set.h"

#include <optional>

#include "common/image_file.h"
#include "common/strict_yaml.h"

namespace bevloc::evaluation {
namespace {

constexpr std::array<std::string_view, 3> kExtensions = {".png", ".jpg", ".jpeg"};

// Limits of a motion between exposures of one frameset.
constexpr double kFarthest_m = 10.0;
constexpr double kMostTurned_deg = 30.0;

/// Nothing if the camera has no file.
Result<std::optional<std::filesystem::path>> file_of(const std::filesystem::path& folder,
                                                     std::string_view camera) {
  std::optional<std::filesystem::path> found;
  for (const std::string_view extension : kExtensions) {
    const std::filesystem::path file = folder / (std::string(camera) + std::string(extension));
    if (!std::filesystem::exists(file)) continue;
    if (found) {
      return fail("{}: found {} and {}, wanted one picture of each camera", folder.string(),
                  found->filename().string(), file.filename().string());
    }
    found = file;
  }
  return found;
}

}  // namespace

CameraImages PictureSet::images() const {
  CameraImages images;
  images.present = present;
  images.reference_from_exposure = reference_from_exposure;
  for (size_t i = 0; i < kCameraCount; ++i) {
    if (present[i]) images.images[i] = pictures[i].view();
  }
  return images;
}

Result<PictureSet> read_pictures(const std::filesystem::path& folder, const Rig& rig) {
  PictureSet set;
  for (size_t i = 0; i < kCameraCount; ++i) {
    const auto file = file_of(folder, kCameraNames[i]);
    if (!file) return tl::unexpected(file.error());
    if (!*file) continue;
    const Intrinsics& intrinsics = rig.cameras[i].intrinsics;
    set.pictures[i] = RgbImage(intrinsics.width_px, intrinsics.height_px);
    if (Status read = read_image((*file)->string(), set.pictures[i]); !read) {
      return tl::unexpected(read.error());
    }
    set.present.set(i);
  }
  if (set.present.none()) {
    return fail("{}: found no picture of a camera, wanted files such as {}.jpg or {}.png",
                folder.string(), kCameraNames[0], kCameraNames[1]);
  }
  return set;
}

Result<CameraMotions> read_motions(const std::filesystem::path& file) {
  auto yaml = YamlMap::read_file(file);
  if (!yaml) return tl::unexpected(yaml.error());
  CameraMotions motions{};
  for (size_t i = 0; i < kCameraCount; ++i) {
    auto motion = yaml->optional_map(kCameraNames[i]);
    if (!motion) continue;
    const auto near = between(-kFarthest_m, kFarthest_m);
    motions[i].x_m = motion->require<double>("x_m", near);
    motions[i].y_m = motion->require<double>("y_m", near);
    motions[i].yaw_rad =
        radians(motion->require<double>("yaw_deg", between(-kMostTurned_deg, kMostTurned_deg)));
  }
  if (Status status = yaml->finish(); !status) return tl::unexpected(status.error());
  return motions;
}

}  // namespace bevloc::evaluation
