// Refines a rig from pictures of a road whose grey levels follow from a formula.
#include "pipeline/calibration/refine/refine_rig.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/pipeline/calibration/refine/road_picture.h"
#include "tests/support/demo_rig.h"

namespace bevloc {
namespace {

constexpr int kFront = 1;
constexpr int kFrontLeft = 0;
constexpr double kWornLine_m = 5.25;
constexpr std::array kWholeLines_m{1.75, -1.75, -5.25};
constexpr double kKerbFromLine_m = 0.37;

HdMap street() {
  HdMap map;
  const auto add_line = [&map](double left_m) {
    map.elements.push_back(
        {ElementClass::kLaneDivider, Appearance::kSolid, {{-60.0, left_m}, {160.0, left_m}}});
  };
  add_line(kWornLine_m);
  for (const double left_m : kWholeLines_m) add_line(left_m);
  return map;
}

/// The street has a worn line on its left, beside a kerb of light stone and a pavement, and three
/// whole lines.
double grey_of_street(double x_m, double y_m) {
  for (const double left_m : kWholeLines_m) {
    if (std::abs(y_m - left_m) < 0.07) return 200.0;
  }
  const bool worn = std::fmod(x_m + 100.0, 2.0) < 0.8;
  if (!worn && std::abs(y_m - kWornLine_m) < 0.07) return 200.0;
  const double from_kerb_m = y_m - kWornLine_m - kKerbFromLine_m;
  if (std::abs(from_kerb_m) < 0.09) return 190.0;
  return from_kerb_m > 0.0 ? 125.0 : 80.0;
}

/// Two cameras record a drive along the street while the body rolls to and fro.
class StreetRecording : public PictureRecording {
 public:
  static constexpr int kFramesets = 20;

  explicit StreetRecording(const Rig& truth, int framesets = kFramesets)
      : reference_(poses()), framesets_(static_cast<size_t>(framesets)) {
    for (const int camera : {kFrontLeft, kFront}) {
      const CameraModel& model = truth.cameras[static_cast<size_t>(camera)];
      const RoadPainter painter(model.intrinsics);
      for (int i = 0; i < framesets; ++i) {
        const Time time = Time{} + from_seconds(1.0 + 0.3 * i);
        const Se2 pose = *reference_.at(time);
        const Se3 body{rotation_by({radians(0.8) * std::sin(2.1 * i), 0.0, 0.0}),
                       Eigen::Vector3d(pose.x_m, pose.y_m, 0.0)};
        framesets_[static_cast<size_t>(i)].push_back(
            {camera, time, painter.picture(body * model.vehicle_from_camera, grey_of_street)});
      }
    }
  }

  const ReferenceTrajectory& reference() const override { return reference_; }
  int framesets() const override { return static_cast<int>(framesets_.size()); }
  void rewind() override { next_ = 0; }
  Status next(std::vector<RecordedPicture>& pictures) override {
    pictures.clear();
    if (next_ < framesets_.size()) pictures = framesets_[next_++];
    return {};
  }

 private:
  static std::vector<ReferenceTrajectory::Pose> poses() {
    std::vector<ReferenceTrajectory::Pose> poses;
    for (int i = 0; i < 1000; ++i) {
      poses.push_back({Time{} + from_seconds(0.01 * i), {0.08 * i, 0.0, 0.0}});
    }
    return poses;
  }

  ReferenceTrajectory reference_;
  std::vector<std::vector<RecordedPicture>> framesets_;
  size_t next_ = 0;
};

TEST(RefineRig, FindsTheLineBesideABrightKerbFromARollingBody) {
  const Rig rig = test::demo_rig();
  Rig truth = rig;
  CameraAdjustment error = CameraAdjustment::Zero();
  error[kYaw] = radians(0.5);
  truth.cameras[kFront] = adjusted(rig.cameras[kFront], error);
  const HdMap map = street();
  StreetRecording recording(truth);
  RefinementOptions options;
  options.free.reset();
  for (const int p : {kPitch, kYaw, kRoll}) options.free.set(static_cast<size_t>(p));
  // The map and the reference are exact, and the body does not lift.
  options.map_m = 1e-3;
  options.reference_position_m = 1e-3;
  options.reference_yaw_rad = 1e-4;
  options.body_lift_m = 1e-3;
  const auto refined = refine_rig(rig, MapIndex(map), recording, options);
  ASSERT_TRUE(refined) << refined.error().message;
  for (const int camera : {kFrontLeft, kFront}) {
    const CameraRefinement& found = refined->cameras[static_cast<size_t>(camera)];
    EXPECT_GT(found.found, 100);
    EXPECT_LT(found.after_px, 0.5);
    for (const int p : {kPitch, kYaw, kRoll}) {
      const double truth_rad = camera == kFront ? error[p] : 0.0;
      if (found.unobservable[static_cast<size_t>(p)]) continue;
      EXPECT_NEAR(found.change[p], truth_rad, radians(0.1)) << kCameraNames[camera] << p;
    }
  }
  EXPECT_FALSE(refined->cameras[kFront].unobservable[kYaw]);
}

TEST(RefineRig, TellsHowFarApartFramesetsMustBe) {
  const Rig rig = test::demo_rig();
  const HdMap map = street();
  StreetRecording recording(rig, 0);
  const auto refined = refine_rig(rig, MapIndex(map), recording, RefinementOptions{});
  ASSERT_FALSE(refined);
  EXPECT_EQ(refined.error().message,
            "pictures: found 0 framesets with a reference pose that are 1.5 m or 2 degrees apart, "
            "wanted 20 or more; drive longer, or check the times of the reference poses");
}

}  // namespace
}  // namespace bevloc
