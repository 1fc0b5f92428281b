#include "evaluation/calib/calib_command.h"

#include <charconv>

#include <fmt/format.h>

#include "common/files.h"
#include "common/json_dump.h"
#include "common/option_checks.h"
#include "common/output_file.h"
#include "common/replace_file.h"
#include "evaluation/calib/calib_picture.h"
#include "evaluation/calib/calib_report.h"
#include "evaluation/calib/folder_recording.h"
#include "evaluation/calib/kept_frameset.h"
#include "evaluation/check_outputs.h"
#include "evaluation/progress_bar.h"
#include "pipeline/calibration/import/import_rig.h"
#include "pipeline/calibration/refine/refine_rig.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_loader.h"

namespace bevloc::evaluation {
namespace {

Result<std::pair<int, int>> image_size_from(const std::string& text) {
  std::pair<int, int> size;
  const char* end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.first);
  if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
    const auto height = std::from_chars(width.ptr + 1, end, size.second);
    if (height.ec == std::errc() && height.ptr == end) return size;
  }
  return fail("--image-size: found {}, wanted WIDTHxHEIGHT, such as 1600x900", text);
}

Result<ParameterSet> free_parameters(const std::vector<std::string>& keep) {
  ParameterSet free;
  free.set();
  for (const std::string& name : keep) {
    if (name == "rotation") {
      for (const int p : {kPitch, kYaw, kRoll}) free.reset(static_cast<size_t>(p));
    } else if (name == "position") {
      for (const int p : {kForward, kLeft, kUp}) free.reset(static_cast<size_t>(p));
    } else if (name == "focal") {
      free.reset(kFocal);
    } else if (name == "time") {
      free.reset(kTimeOffset);
    } else {
      return fail("--keep: found {}, wanted rotation, position, focal or time", name);
    }
  }
  return free;
}

}  // namespace

void CalibCommand::declare(CLI::App& app) {
  auto* calib = app.add_subcommand("calib", "Import, check or refine a calibration");
  calib->require_subcommand(1);
  declare_import(*calib);
  declare_check(*calib);
  declare_refine(*calib);
}

void CalibCommand::declare_import(CLI::App& calib) {
  auto* imports = calib.add_subcommand(
      "import", "Make a rig file of calibrations from Kalibr, OpenCV, ROS, nuScenes or COLMAP");
  imports->add_option("FILE", files_, "Files of the other program")->required();
  imports->add_option("--out", out_, "Rig file to write; the one before is kept as .bak")
      ->required()
      ->check(replaced_file());
  // Each takes one value, because a further one is a FILE.
  imports
      ->add_option(
          "--map-camera", camera_names_,
          "THEIRS=OURS: a camera's name in the files, and its name here, such as cam0=front; "
          "may be repeated")
      ->allow_extra_args(false);
  imports->add_option("--extrinsics", extrinsics_file_,
                      "File with the extrinsics, for formats that have none (docs/calibration.md)");
  imports->add_option("--base", base_file_, "Rig file that supplies what the files lack");
  imports->add_option(
      "--image-size", image_size_,
      "WIDTHxHEIGHT of the images in pixels, for formats that lack it (nuScenes: 1600x900)");
  imports->add_option("--token", tokens_, "Calibrated sensor of nuScenes to use; may be repeated")
      ->allow_extra_args(false);
  imports->footer(
      "Examples:\n"
      "  bevloc calib import camchain.yaml --map-camera cam0=front --base rig.yaml --out new.yaml\n"
      "  bevloc calib import cameras.txt images.txt --base rig.yaml --out new.yaml");
  imports->callback([this] { import_ = true; });
}

void CalibCommand::declare_inputs(CLI::App& command, CalibCommand& self) {
  command.add_option("FOLDER", self.folder_, "Picture folder with reference.csv")->required();
  command.add_option("--rig", self.rig_file_, "Calibration of the cameras")->required();
  command.add_option("--map", self.map_file_, "HD map")->required();
  command
      .add_option("--interval", self.interval_s_, "Least time between two framesets used, seconds")
      ->check(number_between(0.0, 60.0))
      ->capture_default_str();
  command
      .add_option("--position-sigma", self.reference_position_m_,
                  "One sigma of the reference positions, metres")
      ->check(number_between(0.001, 10.0))
      ->capture_default_str();
  command
      .add_option("--yaw-sigma", self.reference_yaw_deg_,
                  "One sigma of the reference headings, degrees")
      ->check(number_between(0.001, 10.0))
      ->capture_default_str();
  command
      .add_option("--picture", self.picture_file_, "Draw the map over pictures to this PNG file")
      ->check(output_file());
  command.add_option("--json", self.json_file_, "Write the result to this file")
      ->check(output_file());
}

void CalibCommand::declare_check(CLI::App& calib) {
  auto* check = calib.add_subcommand("check",
                                     "Compare a picture folder with the map and judge each camera; "
                                     "exit code 1 if one is not good");
  declare_inputs(*check, *this);
  check->footer(
      "Examples:\n"
      "  bevloc calib check pictures --rig rig.yaml --map town.osm --picture check.png");
  check->callback([this] { check_ = true; });
}

void CalibCommand::declare_refine(CLI::App& calib) {
  auto* refine = calib.add_subcommand(
      "refine", "Estimate the calibration of each camera from a picture folder and the map");
  declare_inputs(*refine, *this);
  refine
      ->add_option("--keep", keep_,
                   "What must not change: rotation, position, focal or time; may be repeated")
      ->allow_extra_args(false);
  refine->add_option("--out", out_, "Rig file to write; the one before is kept as .bak")
      ->check(replaced_file());
  refine->footer(
      "Examples:\n"
      "  bevloc calib refine pictures --rig rig.yaml --map town.osm --out refined.yaml");
  refine->callback([this] { refine_ = true; });
}

Result<command::Verdict> CalibCommand::run() const {
  if (import_) return run_import().map([] { return command::Verdict::kGood; });
  return run_on_pictures().map(
      [](bool good) { return good ? command::Verdict::kGood : command::Verdict::kBad; });
}

Status CalibCommand::run_import() const {
  std::vector<std::filesystem::path> inputs(files_.begin(), files_.end());
  inputs.emplace_back(extrinsics_file_);
  if (Status other = check_output(out_, inputs); !other) return other;
  RigImportOptions options;
  auto our_names = parse_camera_names(camera_names_);
  if (!our_names) return tl::unexpected(our_names.error());
  options.our_names = std::move(*our_names);
  if (!extrinsics_file_.empty()) {
    auto given = parse_file(extrinsics_file_, parse_extrinsics);
    if (!given) return tl::unexpected(given.error());
    options.vehicle_from = std::move(*given);
  }
  if (!base_file_.empty()) {
    const auto base = read_rig(base_file_);
    if (!base) return tl::unexpected(base.error());
    options.base = *base;
  }
  if (!image_size_.empty()) {
    const auto size = image_size_from(image_size_);
    if (!size) return tl::unexpected(size.error());
    options.image_size_px = *size;
  }
  options.tokens = tokens_;
  std::vector<ForeignFile> files;
  for (const std::string& name : files_) {
    auto text = read_file(name);
    if (!text) return tl::unexpected(text.error());
    files.push_back({name, std::move(*text)});
  }
  const auto imported = import_rig(files, options);
  if (!imported) return tl::unexpected(imported.error());
  for (const std::string& note : imported->notes) fmt::print("{}\n", note);
  return replace_file_with_backup(out_, format_rig(imported->rig));
}

Result<bool> CalibCommand::run_on_pictures() const {
  const auto rig = read_rig(rig_file_);
  if (!rig) return tl::unexpected(rig.error());
  const auto map = load_map(map_file_);
  if (!map) return tl::unexpected(map.error());
  const MapIndex index(*map);
  auto recording = FolderRecording::open(folder_, *rig, from_seconds(interval_s_));
  if (!recording) return tl::unexpected(recording.error());
  std::vector<std::filesystem::path> inputs = (*recording)->files();
  inputs.emplace_back(map_file_);
  // The rig may be replaced by the refined one, because a backup is kept.
  Status others = check_outputs({out_, json_file_, picture_file_}, inputs);
  if (others) others = check_outputs({json_file_, picture_file_}, {rig_file_});
  if (!others) return tl::unexpected(others.error());
  RefinementOptions options;
  options.reference_position_m = reference_position_m_;
  options.reference_yaw_rad = radians(reference_yaw_deg_);
  const auto free =
      free_parameters(check_ ? std::vector<std::string>{"position", "focal", "time"} : keep_);
  if (!free) return tl::unexpected(free.error());
  options.free = *free;
  KeepingRecording keeping(**recording, index);
  const auto refinement = refine_rig(*rig, index, keeping, options, [](int done, int all) {
    show_progress(done, all, "framesets");
  });
  if (!refinement) return tl::unexpected(refinement.error());
  const CalibrationCheck check{*refinement, folder_, (*recording)->cameras()};
  fmt::print("{}", check_ ? text_of(check) : text_of(*refinement));
  const Rig after = refined(*rig, *refinement);
  if (refine_) fmt::print("{}", time_offsets_of(*refinement));
  if (Status s = write_refined(after); !s) return tl::unexpected(s.error());
  const nlohmann::json json = check_ ? json_of(check) : json_of(*refinement);
  if (Status s = write_option_file(json_file_, json_document(json)); !s) {
    return tl::unexpected(s.error());
  }
  if (!picture_file_.empty()) {
    std::vector<CalibrationView> views = {{"with " + rig_file_, *rig}};
    if (refine_) {
      views.push_back({"refined", after});
      for (size_t c = 0; c < kCameraCount; ++c) {
        views.back().time_offset_s[c] = refinement->cameras[c].change[kTimeOffset];
      }
    }
    const Status drawn = write_calibration_picture(views, keeping.kept(), (*recording)->reference(),
                                                   index, picture_file_);
    if (!drawn) return tl::unexpected(drawn.error());
  }
  return refine_ || all_good(check);
}

Status CalibCommand::write_refined(const Rig& refined) const {
  if (out_.empty()) return {};
  // The text is read again, so that a rig that no vehicle can have is not written.
  const std::string text = format_rig(refined);
  if (const auto sound = parse_rig(text, "refined rig"); !sound) {
    return tl::unexpected(sound.error());
  }
  return replace_file_with_backup(out_, text);
}

}  // namespace bevloc::evaluation
