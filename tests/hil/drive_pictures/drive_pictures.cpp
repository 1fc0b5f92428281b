// drive_pictures: renders the images that the lab's cameras show of a drive, and writes its truth.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/files.h"
#include "evaluation/drive/simulated_drive.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_binary.h"

namespace {

using namespace bevloc;
using namespace bevloc::evaluation;

constexpr double kTruthPeriod_s = 0.01;

uint8_t to_byte(double value) {
  return static_cast<uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

struct Yuv {
  double y, u, v;
};

/// BT.601, limited range, as UVC cameras send YUYV.
Yuv yuv_of(const uint8_t* rgb) {
  const double r = rgb[0], g = rgb[1], b = rgb[2];
  return {16.0 + 0.256788 * r + 0.504129 * g + 0.097906 * b,
          128.0 - 0.148223 * r - 0.290993 * g + 0.439216 * b,
          128.0 + 0.439216 * r - 0.367788 * g - 0.071427 * b};
}

/// Two pixels share one colour: Y0 U Y1 V. The width must be even.
std::string yuyv_from_rgb(const RgbView& image) {
  std::string bytes;
  bytes.reserve(2 * static_cast<size_t>(image.width) * image.height);
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u + 1 < image.width; u += 2) {
      const Yuv left = yuv_of(image.row(v) + 3 * u);
      const Yuv right = yuv_of(image.row(v) + 3 * (u + 1));
      for (const double value :
           {left.y, 0.5 * (left.u + right.u), right.y, 0.5 * (left.v + right.v)}) {
        bytes.push_back(static_cast<char>(to_byte(value)));
      }
    }
  }
  return bytes;
}

std::string truth_csv(const sim::Drive& drive, double duration_s) {
  std::string csv = "time_s,east_m,north_m,yaw_rad,speed_mps\n";
  const auto count = static_cast<int>(duration_s / kTruthPeriod_s);
  for (int row = 0; row <= count; ++row) {
    const double time_s = row * kTruthPeriod_s;
    const sim::Drive::State state = drive.at(time_s);
    csv += fmt::format("{:.2f},{:.4f},{:.4f},{:.6f},{:.3f}\n", time_s, state.map_from_vehicle.x_m,
                       state.map_from_vehicle.y_m, state.map_from_vehicle.yaw_rad, state.speed_mps);
  }
  return csv;
}

/// Renders the images of one camera over the whole drive, on its own clock.
Status draw_camera(const DriveConfig& config, const Rig& rig, const SimulatedDrive& drive,
                   int camera, const std::filesystem::path& folder) {
  drivers::VirtualClock clock;
  auto cameras = drive.make_cameras(config, rig, clock, clock.now());
  drivers::Camera& drawn = *cameras[camera];
  std::filesystem::create_directories(folder);
  if (Status status = drawn.start(); !status) return status;
  const double exposures = config.simulation->duration_s * config.cameras.rate_hz;
  for (int index = 0; index <= static_cast<int>(exposures);) {
    drivers::Frame frame;
    const auto event = drawn.next_frame(std::chrono::seconds(10), frame);
    if (!event) return tl::unexpected(event.error());
    if (*event != drivers::FrameEvent::kFrame) continue;
    const std::string yuyv = yuyv_from_rgb(frame.pixels());
    if (Status status = write_file(folder / fmt::format("{}.yuyv", index), yuyv); !status) {
      return status;
    }
    ++index;
  }
  return {};
}

Status draw(const std::string& config_file, const std::filesystem::path& folder) {
  const auto config = load_drive_config(config_file);
  if (!config) return tl::unexpected(config.error());
  if (!config->simulation) {
    return fail("{}: found no section simulation, wanted a drive", config_file);
  }
  const auto rig = read_rig(config->rig_file);
  if (!rig) return tl::unexpected(rig.error());
  const auto drive = SimulatedDrive::create(*config);
  if (!drive) return tl::unexpected(drive.error());
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const Status drawn =
        draw_camera(*config, *rig, *drive, camera, folder / std::string(kCameraNames[camera]));
    if (!drawn) return drawn;
  }
  const Status map = write_file(folder / "map.bvm", encode_map(drive->map()));
  if (!map) return map;
  const double duration_s = config->simulation->duration_s;
  return write_file(folder / "truth.csv", truth_csv(*drive->drive(), duration_s));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Renders what six cameras see of a drive: FOLDER/<camera>/<number>.yuyv, one per exposure, "
      "truth.csv (the pose every 10 ms) and map.bvm (the map of the drive)");
  std::string config_file;
  std::string folder;
  app.add_option("config", config_file, "Configuration with a section `simulation`")->required();
  app.add_option("folder", folder, "Output folder")->required();
  CLI11_PARSE(app, argc, argv);
  const Status status = draw(config_file, folder);
  if (status) return 0;
  fmt::print(stderr, "drive_pictures: {}\n", status.error().message);
  return 2;
}
