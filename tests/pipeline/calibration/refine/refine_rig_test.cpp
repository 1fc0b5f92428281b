// Refines a rig from pictures of a road whose grey levels follow from a formula.
#include "pipeline/calibration/refine/refine_rig.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "pipeline/calibration/rig_yaml.h"
#include "tests/pipeline/calibration/refine/road_picture.h"

namespace bevloc {
namespace {

constexpr int kFront = 1;
constexpr int kFrontLeft = 0;
constexpr double kLineLeft_m = 5.25;
constexpr double kLineRight_m = -1.75;
constexpr double kKerbFromLine_m = 0.37;

HdMap street() {
  HdMap map;
  for (const double left_m : {kLineLeft_m, kLineRight_m}) {
    map.elements.push_back(
        {ElementClass::kLaneDivider, Appearance::kSolid, {{-60.0, left_m}, {160.0, left_m}}});
  }
  return map;
}

/// A worn line on the left with a kerb of light stone and grass beside it, and one on the right.
double grey_of_street(double x_m, double y_m) {
  if (std::abs(y_m - kLineRight_m) < 0.07) return 200.0;
  const bool worn = std::fmod(x_m + 100.0, 2.0) < 0.8;
  if (!worn && std::abs(y_m - kLineLeft_m) < 0.07) return 200.0;
  const double from_kerb_m = y_m - kLineLeft_m - kKerbFromLine_m;
  if (std::abs(from_kerb_m) < 0.09) return 170.0;
  return from_kerb_m > 0.0 ? 45.0 : 80.0;
}

/// A drive along the street in which the body rolls to and fro. Two cameras see it.
class StreetRecording : public PictureRecording {
 public:
  explicit StreetRecording(const Rig& truth) : reference_(poses()) {
    const RoadPainter painter(truth.cameras[kFront].intrinsics);
    for (int i = 0; i < kFramesets; ++i) {
      const Time time = Time{} + from_seconds(1.0 + 0.3 * i);
      const Se2 pose = *reference_.at(time);
      const Se3 body{rotation_by({radians(0.8) * std::sin(2.1 * i), 0.0, 0.0}),
                     Eigen::Vector3d(pose.x_m, pose.y_m, 0.0)};
      for (const int camera : {kFrontLeft, kFront}) {
        const CameraModel& model = truth.cameras[static_cast<size_t>(camera)];
        framesets_[static_cast<size_t>(i)].push_back(
            {camera, time, painter.picture(body * model.vehicle_from_camera, grey_of_street)});
      }
    }
  }

  const ReferenceTrajectory& reference() const override { return reference_; }
  int framesets() const override { return kFramesets; }
  void rewind() override { next_ = 0; }
  Status next(std::vector<RecordedPicture>& pictures) override {
    pictures.clear();
    if (next_ < framesets_.size()) pictures = framesets_[next_++];
    return {};
  }

 private:
  static constexpr int kFramesets = 20;

  static std::vector<ReferenceTrajectory::Pose> poses() {
    std::vector<ReferenceTrajectory::Pose> poses;
    for (int i = 0; i < 1000; ++i) {
      poses.push_back({Time{} + from_seconds(0.01 * i), {0.08 * i, 0.0, 0.0}});
    }
    return poses;
  }

  ReferenceTrajectory reference_;
  std::array<std::vector<RecordedPicture>, kFramesets> framesets_;
  size_t next_ = 0;
};

TEST(RefineRig, FindsTheLineBesideABrightKerbFromARollingBody) {
  const Rig rig = *read_rig(BEVLOC_SOURCE_DIR "/config/rig_demo.yaml");
  Rig truth = rig;
  CameraAdjustment error = CameraAdjustment::Zero();
  error[kYaw] = radians(0.5);
  truth.cameras[kFront] = adjusted(rig.cameras[kFront], error);
  const HdMap map = street();
  StreetRecording recording(truth);
  RefinementOptions options;
  options.free.reset();
  for (const int p : {kPitch, kYaw, kRoll}) options.free.set(static_cast<size_t>(p));
  const auto refined = refine_rig(rig, MapIndex(map), recording, options);
  ASSERT_TRUE(refined) << refined.error().message;
  for (const int camera : {kFrontLeft, kFront}) {
    const CameraRefinement& found = refined->cameras[static_cast<size_t>(camera)];
    EXPECT_GT(found.found, 100);
    EXPECT_LT(found.after_px, 0.5);
    for (const int p : {kPitch, kYaw, kRoll}) {
      const double truth_rad = camera == kFront ? error[p] : 0.0;
      if (found.unobservable[static_cast<size_t>(p)]) continue;
      // A roll that all cameras share can also be the mean roll of the body.
      const double most_rad = radians(p == kRoll ? 0.4 : 0.15);
      EXPECT_NEAR(found.change[p], truth_rad, most_rad) << kCameraNames[camera] << p;
    }
  }
  EXPECT_FALSE(refined->cameras[kFront].unobservable[kYaw]);
}

}  // namespace
}  // namespace bevloc
