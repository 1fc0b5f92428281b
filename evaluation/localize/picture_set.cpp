#include "evaluation/localize/picture_set.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include "common/image_file.h"
#include "common/strict_yaml.h"

namespace bevloc::evaluation {
namespace {

constexpr std::array<std::string_view, 3> kExtensions = {".png", ".jpg", ".jpeg"};

// Limits of a motion between exposures of one frameset.
constexpr double kFarthest_m = 10.0;
constexpr double kMostTurned_deg = 30.0;

/// The files with the extension of a picture, in the order of their names.
Result<std::vector<std::filesystem::path>> pictures_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code unreadable;
  const std::filesystem::directory_iterator entries(folder, unreadable);
  if (unreadable) {
    return fail("{}: found no folder that can be read ({}), wanted one with the cameras' pictures",
                folder.string(), unreadable.message());
  }
  for (const auto& entry : entries) {
    std::string extension = entry.path().extension();
    for (char& letter : extension) letter = static_cast<char>(std::tolower(letter));
    if (std::ranges::find(kExtensions, extension) != kExtensions.end()) {
      files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  return files;
}

/// Takes the camera's file out of `files`. Returns nothing if there is none.
Result<std::optional<std::filesystem::path>> take_file_of(
    std::string_view camera, std::vector<std::filesystem::path>& files) {
  const auto is_of_camera = [camera](const std::filesystem::path& file) {
    return file.stem() == camera;
  };
  const auto found = std::ranges::find_if(files, is_of_camera);
  if (found == files.end()) return std::nullopt;
  std::filesystem::path file = *found;
  files.erase(found);
  const auto other = std::ranges::find_if(files, is_of_camera);
  if (other != files.end()) {
    return fail("{}: found {} and {}, wanted one picture of each camera",
                file.parent_path().string(), file.filename().string(), other->filename().string());
  }
  return file;
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
  auto files = pictures_in(folder);
  if (!files) return tl::unexpected(files.error());
  PictureSet set;
  set.strays = std::move(*files);
  for (size_t i = 0; i < kCameraCount; ++i) {
    const auto file = take_file_of(kCameraNames[i], set.strays);
    if (!file) return tl::unexpected(file.error());
    if (!*file) continue;
    const Intrinsics& intrinsics = rig.cameras[i].intrinsics;
    set.pictures[i] = RgbImage(intrinsics.width_px, intrinsics.height_px);
    if (Status read = read_camera_picture((*file)->string(), set.pictures[i]); !read) {
      return tl::unexpected(read.error());
    }
    set.files.push_back(**file);
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
