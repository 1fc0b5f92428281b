#include "pipeline/calibration/online/online_calibration.h"

#include <gtest/gtest.h>

#include "tests/pipeline/calibration/online/demo_cells.h"

namespace bevloc {
namespace {

MatchResult clear_match() {
  MatchResult match;
  match.evidence = Evidence::kGood;
  match.covariance.diagonal() << 0.01, 0.0025, radians(0.1) * radians(0.1);
  return match;
}

/// Drives past the same road with true extrinsics that differ by `errors`.
class Driver {
 public:
  explicit Driver(const OnlineCalibrationOptions& options = {})
      : calibration_(cells_.rig(), kFeatureGrid, DemoCells::kChannels, options) {}

  void drive(const ExtrinsicErrors& errors, int framesets, CameraMask blind = {}) {
    cells_.show(errors - calibration_.used_errors(), blind);
    for (int i = 0; i < framesets; ++i) {
      time_ += std::chrono::milliseconds(100);
      const Se2 motion{1.0, 0.0, 0.0};
      path_ = path_ * motion;
      const Se2 matched{path_.x_m, path_.y_m, path_.yaw_rad + heading_against_motion_rad};
      if (calibration_.observe(
              {cells_.match(), match, cameras, time_, tracking, driving, matched, motion})) {
        cells_.show(errors - calibration_.used_errors(), blind);
      }
    }
  }

  const OnlineCalibration& calibration() const { return calibration_; }

  MatchResult match = clear_match();
  CameraMask cameras = CameraMask().set();
  bool tracking = true;
  bool driving = true;
  double heading_against_motion_rad = 0.0;

 private:
  DemoCells cells_;
  OnlineCalibration calibration_;
  Time time_{};
  Se2 path_;
};

const ExtrinsicErrors kSmallError = error_of(1, 0, radians(0.3));

TEST(OnlineCalibration, UsesWhatItLearned) {
  Driver driver;
  driver.drive(kSmallError, 900);
  EXPECT_NEAR(degrees(driver.calibration().used_errors()(kErrorsPerCamera)), 0.3, 0.1);
  EXPECT_TRUE(driver.calibration().faults().none());
}

TEST(OnlineCalibration, FollowsWhatItLearnedSlowly) {
  Driver driver;
  driver.drive(kSmallError, 200);
  EXPECT_GT(degrees(driver.calibration().filter().errors()(kErrorsPerCamera)), 0.2);
  EXPECT_LE(degrees(driver.calibration().used_errors()(kErrorsPerCamera)), 0.1) << "in 20 s";
}

TEST(OnlineCalibration, LearnsOnlyFromClearMatchesWhileItDrivesAndTracks) {
  const auto learned_with = [](auto change) {
    Driver driver;
    change(driver);
    driver.drive(kSmallError, 40);
    return driver.calibration().filter().errors() != ExtrinsicErrors::Zero();
  };
  EXPECT_TRUE(learned_with([](Driver&) {}));
  EXPECT_FALSE(learned_with([](Driver& driver) { driver.tracking = false; }));
  EXPECT_FALSE(learned_with([](Driver& driver) { driver.driving = false; }));
  EXPECT_FALSE(learned_with([](Driver& driver) { driver.cameras.reset(3); }));
  EXPECT_FALSE(learned_with([](Driver& driver) { driver.match.evidence = Evidence::kNone; }));
  EXPECT_FALSE(learned_with([](Driver& driver) { driver.match.correction.y_m = 0.9; }));
  EXPECT_FALSE(learned_with([](Driver& driver) { driver.match.covariance(1, 1) = 0.25; }));
}

TEST(OnlineCalibration, NamesTheCameraThatIsTurnedBeyondTheBounds) {
  Driver driver;
  driver.drive(error_of(4, 0, radians(1.2)), 600);
  EXPECT_EQ(driver.calibration().beyond_bounds(), CameraMask().set(4));
  EXPECT_EQ(driver.calibration().used_errors(), ExtrinsicErrors::Zero())
      << "the camera has pulled the estimates of the others";
}

TEST(OnlineCalibration, LearnsTheTurnOfAllCamerasFromTheDirectionOfMotion) {
  Driver driver;
  driver.heading_against_motion_rad = radians(0.5);
  driver.drive(ExtrinsicErrors::Zero(), 100);
  // Nothing corrects the turn here, so it is learned again and again: only the sign counts.
  double turn_rad = 0.0;
  const Rig rig = demo_network_rig();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const Eigen::Vector3d errors =
        driver.calibration().filter().errors().segment<3>(camera * kErrorsPerCamera);
    turn_rad += (rig.cameras[camera].vehicle_from_camera.rotation * errors).z() / kCameraCount;
  }
  EXPECT_GT(degrees(turn_rad), 0.1);
}

TEST(OnlineCalibration, RestoresWhatIsWithinTheBounds) {
  OnlineCalibration calibration(demo_network_rig(), kFeatureGrid, DemoCells::kChannels, {});
  const ExtrinsicCovariance covariance = 1e-6 * ExtrinsicCovariance::Identity();
  EXPECT_FALSE(calibration.restore(error_of(1, 0, radians(0.7)), covariance));
  EXPECT_EQ(calibration.used_errors(), ExtrinsicErrors::Zero());
  EXPECT_TRUE(calibration.restore(kSmallError, covariance));
  EXPECT_EQ(calibration.used_errors(), kSmallError);
}

TEST(OnlineCalibration, NamesCamerasThatShowAnotherRoad) {
  Driver driver;
  driver.tracking = false;
  driver.drive(ExtrinsicErrors::Zero(), 100, CameraMask().set(1).set(4));
  EXPECT_TRUE(driver.calibration().contradicting().none()) << "too early to say";
  driver.drive(ExtrinsicErrors::Zero(), 100, CameraMask().set(1).set(4));
  EXPECT_TRUE(driver.calibration().contradicting()[1]);
  EXPECT_TRUE(driver.calibration().contradicting()[4]);
  driver.drive(ExtrinsicErrors::Zero(), 1000);
  EXPECT_TRUE(driver.calibration().faults().none());
}

}  // namespace
}  // namespace bevloc
