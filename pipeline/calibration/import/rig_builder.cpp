#include "pipeline/calibration/import/rig_builder.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pipeline/calibration/import/camera_names.h"
#include "pipeline/calibration/import/foreign_node.h"

namespace bevloc::calibration_import {
namespace {

/// Whether the file places a camera relative to `parent`: another camera, or another frame.
bool hangs_on(const ImportedCamera& camera, std::string_view parent, bool is_camera) {
  return camera.mounting && camera.mounting->is_on_camera == is_camera &&
         camera.mounting->parent == parent;
}

class RigBuilder {
 public:
  RigBuilder(std::vector<ImportedCamera> cameras, const RigImportOptions& options)
      : cameras_(std::move(cameras)), options_(options) {}

  BuiltRig build() {
    check_names();
    check_places();
    check_image_size();
    for (int i = 0; i < kCameraCount; ++i) built_.rig.cameras[i] = camera_named(i);
    note_left_out();
    return std::move(built_);
  }

 private:
  std::string our_name(const ImportedCamera& camera) const {
    const auto mapped = options_.our_names.find(camera.name);
    return mapped == options_.our_names.end() ? camera.name : mapped->second;
  }

  bool is_imported(std::string_view ours) const {
    return std::ranges::any_of(
        cameras_, [&](const ImportedCamera& camera) { return our_name(camera) == ours; });
  }

  void check_names() const {
    for (const auto& [theirs, ours] : options_.our_names) {
      const auto named = [&name = theirs](const auto& camera) { return camera.name == name; };
      if (std::ranges::none_of(cameras_, named)) {
        refuse("--map-camera", theirs, fmt::format("one of the files' cameras: {}", names()));
      }
      if (!is_ours(ours)) {
        refuse("--map-camera", ours, fmt::format("one of {}", fmt::join(kCameraNames, ", ")));
      }
    }
    if (std::ranges::none_of(kCameraNames, [&](auto ours) { return is_imported(ours); })) {
      refuse(cameras_.front().place,
             fmt::format("only cameras that have none of bevloc's names: {}", names()),
             fmt::format("--map-camera THEIRS=OURS, such as {}=front", cameras_.front().name));
    }
  }

  /// Refuses a place that no imported camera needs.
  void check_places() const {
    for (const auto& [frame, place] : options_.vehicle_from) {
      if (is_ours(frame)) {
        if (is_imported(frame)) continue;
        refuse("--extrinsics", fmt::format("{}, which is no imported camera", frame),
               fmt::format("places of imported cameras only; the files have {}, and --map-camera "
                           "names them",
                           names()));
      }
      const auto hangs_on_frame = [&name = frame](const ImportedCamera& camera) {
        return hangs_on(camera, name, false);
      };
      if (std::ranges::any_of(cameras_, hangs_on_frame)) continue;
      refuse("--extrinsics", frame,
             fmt::format("places that are needed only; the files place no camera relative to {}",
                         frame));
    }
  }

  /// Refuses the option for the size of images if every file states the size itself.
  void check_image_size() const {
    const auto lacks_size = [](const ImportedCamera& camera) {
      return camera.intrinsics.width_px == 0;
    };
    if (!options_.image_size_px || std::ranges::any_of(cameras_, lacks_size)) return;
    refuse("--image-size", "files that all state the size of their images", "no such option");
  }

  std::string names() const {
    std::vector<std::string> found;
    for (const ImportedCamera& camera : cameras_) found.push_back(camera.name);
    return fmt::format("{}", fmt::join(found, ", "));
  }

  const ImportedCamera* find(std::string_view ours) const {
    const ImportedCamera* found = nullptr;
    for (const ImportedCamera& camera : cameras_) {
      if (our_name(camera) != ours) continue;
      if (found) {
        refuse(camera.place, fmt::format("a second camera {} (first at {})", ours, found->place),
               "one of each name; leave one out, or give it another name in its file");
      }
      found = &camera;
    }
    return found;
  }

  CameraModel camera_named(int index) {
    const std::string name(kCameraNames[index]);
    CameraSource& source = built_.sources[static_cast<size_t>(index)];
    const ImportedCamera* found = find(name);
    if (!found) {
      if (!options_.base) {
        refuse(name, fmt::format("no such camera among {}", names()),
               "all six: name it with --map-camera THEIRS=OURS, or give --base RIG");
      }
      built_.notes.push_back(fmt::format("{}: as in the base", name));
      source = {"--base", "--base"};
      return options_.base->cameras[index];
    }
    source = {found->place_of_lens(), found->place};
    CameraModel camera;
    camera.intrinsics = sized_intrinsics(*found);
    std::string body_note;
    if (options_.base) body_note = take_own_body(options_.base->cameras[index], camera);
    std::string origin = "the files";
    std::set<std::string> visited;
    std::optional<Se3> placed = vehicle_from(*found, visited);
    if (options_.vehicle_from.contains(name)) {
      origin = source.extrinsics = "--extrinsics";
    } else if (!placed && options_.base) {
      placed = options_.base->cameras[index].vehicle_from_camera;
      origin = "the base";
      source.extrinsics = "--base";
    }
    if (!placed) refuse(found->place, lacks(*found), wanted_for(*found, name));
    camera.vehicle_from_camera = *placed;
    const std::string_view lens = camera.intrinsics.lens == Lens::kFisheye ? "fisheye" : "pinhole";
    const std::string lens_note = found->lens_doubt.empty() ? "" : ", " + found->lens_doubt;
    built_.notes.push_back(fmt::format("{}: {} ({}), {}{}, extrinsics from {}{}", name,
                                       found->place, found->name, lens, lens_note, origin,
                                       body_note));
    return camera;
  }

  void note_left_out() {
    for (const ImportedCamera& camera : cameras_) {
      if (is_ours(our_name(camera))) continue;
      built_.notes.push_back(fmt::format(
          "{}: {} is left out, because it has none of bevloc's names; --map-camera {}=OURS gives "
          "it one",
          camera.place, camera.name, camera.name));
    }
  }

  /// Takes the outline of the own vehicle from the base, because no other program has one. Returns
  /// the end of the camera's note.
  static std::string take_own_body(const CameraModel& base, CameraModel& camera) {
    if (base.own_body_px.empty()) return "";
    const Intrinsics& lens = camera.intrinsics;
    if (base.intrinsics.width_px != lens.width_px || base.intrinsics.height_px != lens.height_px) {
      return ", without the base's own_body_px, which is for images of another size: measure it "
             "again";
    }
    camera.own_body_px = base.own_body_px;
    return ", own_body_px from the base";
  }

  Intrinsics sized_intrinsics(const ImportedCamera& camera) const {
    Intrinsics sized = camera.intrinsics;
    if (sized.width_px != 0) return sized;
    if (!options_.image_size_px) {
      refuse(camera.place, "no size of the images", "--image-size WIDTHxHEIGHT");
    }
    sized.width_px = options_.image_size_px->first;
    sized.height_px = options_.image_size_px->second;
    return sized;
  }

  static std::string lacks(const ImportedCamera& camera) {
    return camera.mounting ? fmt::format("a pose relative to {}", camera.mounting->parent)
                           : std::string("no pose on the vehicle");
  }

  static std::string wanted_for(const ImportedCamera& camera, const std::string& ours) {
    const bool has_frame = camera.mounting && !camera.mounting->is_on_camera;
    const std::string frame = has_frame ? camera.mounting->parent : ours;
    return fmt::format(
        "its place: --extrinsics FILE with `{}: {{translation_m: [x, y, z], rotation_wxyz: "
        "[w, x, y, z]}}` (vehicle_from_{}), or --base RIG",
        frame, has_frame ? frame : "camera");
  }

  std::optional<Se3> given_place(const std::string& frame) const {
    const auto given = options_.vehicle_from.find(frame);
    if (given == options_.vehicle_from.end()) return std::nullopt;
    return given->second;
  }

  /// Follows the chain of parents in both directions: a camera whose child has a known place has
  /// one, too. `visited` holds the names that the files use.
  std::optional<Se3> vehicle_from(const ImportedCamera& camera,
                                  std::set<std::string>& visited) const {
    if (!visited.insert(camera.name).second) return std::nullopt;
    const std::string ours = our_name(camera);
    const auto given = is_ours(ours) ? given_place(ours) : std::nullopt;
    if (given) return given;
    if (camera.mounting) {
      const auto placed = vehicle_from_parent(*camera.mounting, visited);
      if (placed) return *placed * camera.mounting->parent_from_camera;
    }
    return vehicle_from_child_of(camera.name, true, visited);
  }

  /// The place of a camera or of another frame, computed from a camera whose place is given
  /// relative to it.
  std::optional<Se3> vehicle_from_child_of(const std::string& parent, bool is_camera,
                                           std::set<std::string>& visited) const {
    for (const ImportedCamera& child : cameras_) {
      if (!hangs_on(child, parent, is_camera)) continue;
      if (const auto placed = vehicle_from(child, visited)) {
        return *placed * child.mounting->parent_from_camera.inverse();
      }
    }
    return std::nullopt;
  }

  std::optional<Se3> vehicle_from_parent(const Mounting& mounting,
                                         std::set<std::string>& visited) const {
    if (!mounting.is_on_camera) {
      if (mounting.parent == "vehicle") return Se3{};
      if (const auto given = given_place(mounting.parent)) return given;
      return vehicle_from_child_of(mounting.parent, false, visited);
    }
    for (const ImportedCamera& other : cameras_) {
      if (other.name != mounting.parent) continue;
      if (const auto placed = vehicle_from(other, visited)) return placed;
    }
    return std::nullopt;
  }

  std::vector<ImportedCamera> cameras_;
  const RigImportOptions& options_;
  BuiltRig built_;
};

}  // namespace

BuiltRig build_rig(std::vector<ImportedCamera> cameras, const RigImportOptions& options) {
  return RigBuilder(std::move(cameras), options).build();
}

}  // namespace bevloc::calibration_import
