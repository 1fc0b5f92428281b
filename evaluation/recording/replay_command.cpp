#include "evaluation/recording/replay_command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/files.h"
#include "common/json_dump.h"
#include "common/option_checks.h"
#include "common/output_file.h"
#include "evaluation/check_outputs.h"
#include "evaluation/recording/candump_inputs.h"
#include "evaluation/recording/replay_inputs.h"
#include "evaluation/recording/track.h"
#include "firmware/recording/topics.h"

namespace bevloc::evaluation {
namespace {

/// How far the poses are from others at the same times.
struct Distances {
  size_t count = 0;
  double mean_m = 0.0;
  double largest_m = 0.0;
};

Distances distances(const std::vector<ReplayedPose>& poses, const Track& track) {
  Distances result;
  for (const ReplayedPose& pose : poses) {
    const auto other = pose_at(track, pose.time);
    if (!claims_pose(pose.state) || !pose.map_from_vehicle || !other) continue;
    const double distance_m = (pose.map_from_vehicle->translation() - other->translation()).norm();
    ++result.count;
    result.mean_m += distance_m;
    result.largest_m = std::max(result.largest_m, distance_m);
  }
  if (result.count > 0) result.mean_m /= static_cast<double>(result.count);
  return result;
}

void print_distances(const char* name, const Distances& found) {
  if (found.count == 0) return;
  fmt::print("{:<10}mean {:.3f} m, largest {:.3f} m over {} valid poses\n", name, found.mean_m,
             found.largest_m, found.count);
}

nlohmann::json json_of(const Distances& found) {
  if (found.count == 0) return nullptr;
  return {{"poses", found.count}, {"mean_m", found.mean_m}, {"largest_m", found.largest_m}};
}

}  // namespace

void ReplayCommand::declare(CLI::App& app) {
  auto* replay = app.add_subcommand("replay", "Run the real pipeline on a recording");
  replay->add_option("files", files_, "Files of one recording (.mcap), in any order");
  replay
      ->add_option("--config", overrides_.config,
                   "Another configuration, with its calibration, model and solver")
      ->check(is_name_of("a configuration"));
  replay->add_option("--model", overrides_.model, "Another model (.onnx)")
      ->check(is_name_of("a model"));
  replay->add_option("--map", overrides_.map, "Another map")->check(is_name_of("a map"));
  replay
      ->add_option("--from-candump", candump_,
                   "The bus from a candump log; needs --config and --images")
      ->check(is_name_of("a log"));
  replay
      ->add_option("--images", images_,
                   "With --from-candump: one folder per camera with pictures and frames.txt")
      ->check(is_name_of("a folder"));
  replay->add_option("--out", out_, "Folder for can.log and poses.csv")
      ->check(is_name_of("a folder"))
      ->capture_default_str();
  replay->add_option("--json", json_file_, "Write the result as JSON to this file")
      ->check(output_name());
  replay->footer(
      "Examples:\n"
      "  bevloc replay recording/*.mcap --out replay\n"
      "  bevloc replay --from-candump bus.log --images pictures --config my_config.yaml");
}

Status ReplayCommand::run() const {
  const bool candump = !candump_.empty();
  if (candump == !files_.empty()) {
    return fail("replay: found {}, wanted the files of a recording or --from-candump",
                candump ? "both" : "nothing to replay");
  }
  if (!candump && !images_.empty()) {
    return fail(
        "--images: found no --from-candump, wanted both, or the files of a recording alone");
  }
  if (candump && (overrides_.config.empty() || images_.empty())) {
    return fail("--from-candump: found no --config or no --images, wanted both");
  }
  if (Status others = check_outputs(); !others) return others;
  if (Status made = create_folder(out_); !made) return made;
  if (Status writable = check_writable(json_file_); !writable) return writable;
  return candump ? replay_candump() : replay_recording();
}

Status ReplayCommand::check_outputs() const {
  std::vector<std::filesystem::path> inputs = files_;
  inputs.insert(inputs.end(), {candump_, overrides_.config, overrides_.model, overrides_.map});
  return evaluation::check_outputs({json_file_, can_log(), poses_file()}, inputs);
}

Status ReplayCommand::write_poses(const ReplayOutcome& outcome, Time begin) const {
  std::string csv = "time_s,state,x_m,y_m,yaw_rad\n";
  for (const ReplayedPose& pose : outcome.poses) {
    if (!pose.map_from_vehicle) continue;
    fmt::format_to(std::back_inserter(csv), "{:.3f},{},{:.4f},{:.4f},{:.6f}\n",
                   to_seconds(pose.time - begin), to_string(pose.state), pose.map_from_vehicle->x_m,
                   pose.map_from_vehicle->y_m, pose.map_from_vehicle->yaw_rad);
  }
  return write_file(poses_file(), csv);
}

Status ReplayCommand::replay_recording() const {
  auto recording = Recording::open(files_);
  if (!recording) return tl::unexpected(recording.error());
  for (const std::string& gap : recording->gaps()) fmt::print(stderr, "{}\n", gap);
  if (recording->end_ns() == 0) {
    return fail("{}: found no message of a drive, wanted a recording that holds some",
                recording->name());
  }
  const auto scratch = ScratchFolder::create();
  if (!scratch) return tl::unexpected(scratch.error());
  const auto setup = setup_of(*recording, overrides_, *scratch);
  if (!setup) return tl::unexpected(setup.error());
  const auto inputs = inputs_of(*recording, setup->rig);
  if (!inputs) return tl::unexpected(inputs.error());
  const auto recorded = played_frames(*recording, firmware::kBusOutTopic);
  if (!recorded) return tl::unexpected(recorded.error());
  const auto poses = read_track(*recording, firmware::kPoseTopic);
  const auto truth = read_track(*recording, firmware::kTruthTopic);
  if (!poses || !truth) return tl::unexpected((poses ? truth : poses).error());
  const auto outcome = replay(*setup, *inputs, can_log());
  if (!outcome) return tl::unexpected(outcome.error());
  if (Status written = write_poses(*outcome, inputs->begin); !written) return written;

  const BusComparison bus = compare_bus(*recorded, outcome->sent);
  const Distances to_recorded = distances(outcome->poses, *poses);
  const Distances to_truth = distances(outcome->poses, *truth);
  fmt::print("replayed  {:.1f} s, {} framesets\n", to_seconds(inputs->end - inputs->begin),
             outcome->framesets);
  fmt::print("{}", bus_text(bus, recording->value(firmware::kLockstepKey) == "no"));
  print_distances("recorded", to_recorded);
  print_distances("truth", to_truth);
  const nlohmann::json json{{"framesets", outcome->framesets},  {"frames_recorded", bus.recorded},
                            {"frames_replayed", bus.replayed},  {"frames_equal", bus.equal},
                            {"recorded", json_of(to_recorded)}, {"truth", json_of(to_truth)}};
  return write_option_file(json_file_, json_document(json));
}

Status ReplayCommand::replay_candump() const {
  const auto setup = setup_of(overrides_);
  if (!setup) return tl::unexpected(setup.error());
  const auto inputs = inputs_of_candump(candump_, images_, *setup);
  if (!inputs) return tl::unexpected(inputs.error());
  const auto outcome = replay(*setup, *inputs, can_log());
  if (!outcome) return tl::unexpected(outcome.error());
  if (Status written = write_poses(*outcome, inputs->begin); !written) return written;
  fmt::print("replayed  {:.1f} s, {} framesets\n", to_seconds(inputs->end - inputs->begin),
             outcome->framesets);
  fmt::print("bus       {} frames in {}\n", outcome->sent.size(), can_log().string());
  const nlohmann::json json{{"framesets", outcome->framesets},
                            {"frames_replayed", outcome->sent.size()}};
  return write_option_file(json_file_, json_document(json));
}

}  // namespace bevloc::evaluation
