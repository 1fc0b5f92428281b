#include "training/drives/drive_sample.h"

#include <algorithm>

#include "pipeline/bev_grid.h"
#include "pipeline/preprocessing/network_camera.h"
#include "sim/samples/sample_maker.h"

namespace bevloc::drives {
namespace {

/// The name of a frameset in messages: "FILE, 12.3 s".
std::string name_of(const DriveIndex& drive, const SamplePlace& place) {
  const Time time = drive.framesets[place.frameset].time;
  return fmt::format("{}, {:.2f} s after its first frameset", drive.name,
                     to_seconds(time - drive.framesets.front().time));
}

}  // namespace

SampleChoice random_choice(uint64_t seed, uint64_t sample, double drop_camera_probability) {
  sim::Random random(sim::seed_for(seed, "drive sample") + sample);
  SampleChoice choice;
  choice.correction = sim::random_correction(random);
  choice.cameras = sim::random_cameras({.probability = drop_camera_probability}, random);
  return choice;
}

DriveSampleMaker::DriveSampleMaker(DriveSet& set, const MapIndex& map)
    : set_(set), rasterizer_(map), planes_(kNetworkImageSize) {
  for (size_t i = 0; i < set.drives(); ++i) {
    const Rig& rig = set.drive(i).index().rig;
    Cameras cameras{{}, network_rig(rig)};
    for (const CameraModel& camera : rig.cameras) cameras.preprocessors.emplace_back(camera);
    cameras_.push_back(std::move(cameras));
  }
}

Status DriveSampleMaker::make(const SamplePlace& place, const SampleChoice& choice,
                              DriveSample& sample) {
  const DriveIndex& drive = set_.drive(place.drive).index();
  std::array<Time, kCameraCount> exposures{};
  if (Status read = read_images(place, choice.cameras, sample, exposures); !read) return read;
  Time reference_time = Time::max();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (sample.cameras[camera]) reference_time = std::min(reference_time, exposures[camera]);
  }
  const auto map_from_vehicle = drive.reference.at(reference_time);
  CameraMotions reference_from_exposure{};
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (!sample.cameras[camera]) continue;
    const auto at_exposure = drive.reference.at(exposures[camera]);
    if (!map_from_vehicle || !at_exposure) {
      return fail("{}: found no reference pose at the time of {}, wanted one",
                  name_of(drive, place), kCameraNames[camera]);
    }
    if (exposures[camera] - reference_time > kWidestSpread) {
      return fail("{}: found {} exposed {:.0f} ms after the first camera, wanted at most {:.0f} ms",
                  name_of(drive, place), kCameraNames[camera],
                  to_milliseconds(exposures[camera] - reference_time),
                  to_milliseconds(kWidestSpread));
    }
    reference_from_exposure[camera] = map_from_vehicle->inverse() * *at_exposure;
  }
  sample.correction = choice.correction;
  sample.raster_truth.resize(kRasterSize);
  rasterizer_.draw(*map_from_vehicle, sample.raster_truth);
  if (std::ranges::count(sample.raster_truth, 0) == std::ssize(sample.raster_truth)) {
    return fail(
        "{}: found nothing of the map around {:.1f}, {:.1f}, wanted lines; is it the map of "
        "this drive?",
        name_of(drive, place), map_from_vehicle->x_m, map_from_vehicle->y_m);
  }
  sample.raster_prior.resize(kRasterSize);
  rasterizer_.draw(*map_from_vehicle * choice.correction.inverse(), sample.raster_prior);
  update_view_table(cameras_[place.drive].network_rig, sample.cameras, kFeatureGrid,
                    reference_from_exposure, sample.table);
  return {};
}

Status DriveSampleMaker::read_images(const SamplePlace& place, const CameraMask& wanted,
                                     DriveSample& sample,
                                     std::array<Time, kCameraCount>& exposures) {
  RecordedDrive& drive = set_.drive(place.drive);
  const FramesetPlace& frameset = drive.index().framesets[place.frameset];
  sample.cameras = frameset.present & wanted;
  if (sample.cameras.none()) sample.cameras = frameset.present;
  sample.images.assign(kCameraCount * kNetworkImageSize, 0);
  for (int camera = 0; camera < kCameraCount; ++camera) {
    if (!sample.cameras[camera]) continue;
    const auto time =
        drive.read(frameset, camera,
                   cameras_[place.drive].preprocessors[static_cast<size_t>(camera)], planes_);
    if (!time) {
      return fail("{}: {}", name_of(drive.index(), place), time.error().message);
    }
    exposures[camera] = *time;
    std::ranges::transform(planes_, sample.images.begin() + camera * std::ssize(planes_),
                           [](int8_t value) { return static_cast<uint8_t>(value + 128); });
  }
  return {};
}

}  // namespace bevloc::drives
