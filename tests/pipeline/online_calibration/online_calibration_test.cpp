#include "pipeline/online_calibration/online_calibration.h"

#include <gtest/gtest.h>

#include "tests/pipeline/online_calibration/demo_driver.h"

namespace bevloc {
namespace {

const ExtrinsicErrors kSmallError = error_of(1, 0, radians(0.3));

TEST(OnlineCalibration, UsesWhatItLearned) {
  DemoDriver driver;
  driver.drive(kSmallError, 900);
  EXPECT_NEAR(degrees(driver.calibration().used_errors()(kErrorsPerCamera)), 0.3, 0.1);
  EXPECT_TRUE(driver.calibration().faults().none());
}

TEST(OnlineCalibration, FollowsWhatItLearnedSlowly) {
  DemoDriver driver;
  driver.drive(kSmallError, 200);
  EXPECT_GT(degrees(driver.calibration().filter().errors()(kErrorsPerCamera)), 0.2);
  EXPECT_LE(degrees(driver.calibration().used_errors()(kErrorsPerCamera)), 0.1) << "in 20 s";
}

TEST(OnlineCalibration, FollowsSlowlyAlsoAfterALongTimeWithoutChanges) {
  DemoDriver driver;
  driver.drive_blank(6000);
  ASSERT_EQ(driver.calibration().used_errors(), ExtrinsicErrors::Zero());
  driver.drive(kSmallError, 100);
  const ExtrinsicErrors moved = driver.calibration().used_errors().cwiseAbs();
  EXPECT_GT(moved.maxCoeff(), 0.0);
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const int first = camera * kErrorsPerCamera;
    EXPECT_LT(degrees(moved.segment<3>(first).maxCoeff()), 0.1) << camera;
    EXPECT_LT(moved.segment<3>(first + 3).maxCoeff(), 0.012) << camera;
  }
}

TEST(OnlineCalibration, LearnsOnlyFromClearMatchesWhileItDrivesAndTracks) {
  const auto learned_with = [](auto change) {
    DemoDriver driver;
    change(driver);
    driver.drive(kSmallError, 40);
    return driver.calibration().filter().errors() != ExtrinsicErrors::Zero();
  };
  EXPECT_TRUE(learned_with([](DemoDriver&) {}));
  EXPECT_FALSE(learned_with([](DemoDriver& driver) { driver.tracking = false; }));
  EXPECT_FALSE(learned_with([](DemoDriver& driver) { driver.driving = false; }));
  EXPECT_FALSE(learned_with([](DemoDriver& driver) { driver.cameras.reset(3); }));
  EXPECT_FALSE(learned_with([](DemoDriver& driver) { driver.match.evidence = Evidence::kNone; }));
  EXPECT_FALSE(learned_with([](DemoDriver& driver) { driver.match.correction.y_m = 0.9; }));
  EXPECT_FALSE(learned_with([](DemoDriver& driver) { driver.match.covariance(1, 1) = 0.25; }));
}

TEST(OnlineCalibration, NamesTheCameraThatIsTurnedBeyondTheBounds) {
  DemoDriver driver;
  driver.drive(error_of(4, 0, radians(1.2)), 600);
  EXPECT_EQ(driver.calibration().faults(), CameraMask().set(4));
  EXPECT_TRUE(driver.calibration().contradicting().none()) << "its errors alone are the fault";
  EXPECT_EQ(driver.calibration().used_errors(), ExtrinsicErrors::Zero())
      << "the camera has pulled the estimates of the others";
}

TEST(OnlineCalibration, LearnsTheTurnOfAllCamerasFromTheDirectionOfMotion) {
  DemoDriver driver;
  driver.heading_against_motion_rad = radians(0.5);
  driver.drive(ExtrinsicErrors::Zero(), 100);
  // Nothing corrects the turn here, so it is learned again and again. Only the sign counts.
  double turn_rad = 0.0;
  const Rig rig = demo_network_rig();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const Eigen::Vector3d errors =
        driver.calibration().filter().errors().segment<3>(camera * kErrorsPerCamera);
    turn_rad += (rig.cameras[camera].vehicle_from_camera.rotation * errors).z() / kCameraCount;
  }
  EXPECT_GT(degrees(turn_rad), 0.1);
}

/// The pose before the loss lies beside the one after it. A comparison across the loss would take
/// this for a turn of all cameras.
TEST(OnlineCalibration, LearnsNoHeadingAcrossALossOfThePose) {
  const auto errors_after_loss = [](double beside_m) {
    DemoDriver driver;
    driver.beside_m = beside_m;
    driver.drive(ExtrinsicErrors::Zero(), 25);
    driver.tracking = false;
    driver.drive(ExtrinsicErrors::Zero(), 15);
    driver.tracking = true;
    driver.beside_m = 0.0;
    driver.drive(ExtrinsicErrors::Zero(), 30);
    return driver.calibration().filter().errors();
  };
  EXPECT_EQ(errors_after_loss(1.0), errors_after_loss(0.0));
}

TEST(OnlineCalibration, RestoresWhatIsWithinTheBounds) {
  OnlineCalibration calibration(demo_network_rig(), kFeatureGrid, {});
  const ExtrinsicCovariance covariance = 1e-6 * ExtrinsicCovariance::Identity();
  EXPECT_FALSE(calibration.restore(error_of(1, 0, radians(0.7)), covariance));
  EXPECT_EQ(calibration.used_errors(), ExtrinsicErrors::Zero());
  EXPECT_TRUE(calibration.restore(kSmallError, covariance));
  EXPECT_EQ(calibration.used_errors(), kSmallError);
}

/// Errors that are no fault while the vehicle drives are saved, so a later start must accept them.
TEST(OnlineCalibration, RestoresWhatIsBeyondABoundByLessThanHalfASigma) {
  const OnlineCalibrationOptions options;
  OnlineCalibration calibration(demo_network_rig(), kFeatureGrid, options);
  const double sigma_rad = 1e-3;
  const ExtrinsicCovariance covariance = sigma_rad * sigma_rad * ExtrinsicCovariance::Identity();
  const auto beyond_by = [&](double sigmas) {
    return error_of(1, 0, -options.max_rotation_rad - sigmas * sigma_rad);
  };
  EXPECT_FALSE(calibration.restore(beyond_by(0.6), covariance));
  EXPECT_TRUE(calibration.restore(beyond_by(0.4), covariance));
  EXPECT_EQ(calibration.filter().errors(), beyond_by(0.4));
  EXPECT_EQ(calibration.used_errors(), error_of(1, 0, -options.max_rotation_rad));
  EXPECT_TRUE(calibration.faults().none());
}

TEST(OnlineCalibration, SaysWhyItRestoresNothing) {
  OnlineCalibration calibration(demo_network_rig(), kFeatureGrid, {});
  const ExtrinsicCovariance covariance = 1e-6 * ExtrinsicCovariance::Identity();
  const auto beyond = calibration.restore(error_of(1, 0, radians(0.7)), covariance);
  ASSERT_FALSE(beyond);
  EXPECT_NE(beyond.error().message.find("front beyond"), std::string::npos)
      << beyond.error().message;
  const auto indefinite = calibration.restore(kSmallError, -covariance);
  ASSERT_FALSE(indefinite);
  EXPECT_NE(indefinite.error().message.find("positive definite"), std::string::npos)
      << indefinite.error().message;
  EXPECT_EQ(calibration.used_errors(), ExtrinsicErrors::Zero());
}

TEST(OnlineCalibration, NamesACameraOnlyAfterItHasContradictedTheMapForSomeSeconds) {
  DemoDriver driver;
  driver.drive(ExtrinsicErrors::Zero(), 150);
  const auto named_after_s = [&driver] {
    for (int after_s = 1; after_s <= 60; ++after_s) {
      driver.drive(ExtrinsicErrors::Zero(), 10, CameraMask().set(0));
      if (driver.calibration().contradicting().any()) return after_s;
    }
    return 0;
  };
  const int crossed_s = 11;  // its agreement falls below the limit
  EXPECT_GE(named_after_s(), crossed_s + 3);
}

TEST(OnlineCalibration, NamesTwoCamerasOfOneSideLater) {
  const CameraMask left = CameraMask().set(0).set(3);
  DemoDriver driver;
  driver.tracking = false;
  driver.drive(ExtrinsicErrors::Zero(), 450, left);
  EXPECT_TRUE(driver.calibration().faults().none())
      << "the road may differ from the map on that side";
  driver.drive(ExtrinsicErrors::Zero(), 150, left);
  EXPECT_EQ(driver.calibration().contradicting(), left);
}

TEST(OnlineCalibration, NamesCamerasThatShowAnotherRoad) {
  DemoDriver driver;
  driver.tracking = false;
  driver.drive(ExtrinsicErrors::Zero(), 100, CameraMask().set(1).set(4));
  EXPECT_TRUE(driver.calibration().contradicting().none()) << "too early to say";
  driver.drive(ExtrinsicErrors::Zero(), 120, CameraMask().set(1).set(4));
  EXPECT_TRUE(driver.calibration().contradicting()[1]);
  EXPECT_TRUE(driver.calibration().contradicting()[4]);
  driver.drive(ExtrinsicErrors::Zero(), 1000);
  EXPECT_TRUE(driver.calibration().faults().none());
}

TEST(OnlineCalibration, NamesACameraWhileAnotherIsMissing) {
  DemoDriver driver;
  driver.cameras.reset(1);
  driver.drive(ExtrinsicErrors::Zero(), 250, CameraMask().set(4));
  EXPECT_EQ(driver.calibration().contradicting(), CameraMask().set(4));
}

TEST(OnlineCalibration, JudgesACameraThatComesBackOnlyAfterSomeSeconds) {
  const CameraMask back = CameraMask().set(4);
  DemoDriver driver;
  driver.cameras.reset(4);
  driver.drive(ExtrinsicErrors::Zero(), 300);
  driver.cameras.set(4);
  driver.drive(ExtrinsicErrors::Zero(), 120, back);
  EXPECT_TRUE(driver.calibration().faults().none());
  driver.drive(ExtrinsicErrors::Zero(), 100, back);
  EXPECT_EQ(driver.calibration().contradicting(), back);
}

TEST(OnlineCalibration, KeepsTheVerdictOfACameraThatIsLeftOut) {
  DemoDriver driver;
  driver.drive(ExtrinsicErrors::Zero(), 250, CameraMask().set(4));
  driver.cameras.reset(4);
  driver.drive(ExtrinsicErrors::Zero(), 600);
  EXPECT_EQ(driver.calibration().contradicting(), CameraMask().set(4));
}

TEST(OnlineCalibration, JudgesACameraThatComesBackByWhatItShowsThen) {
  const CameraMask back = CameraMask().set(4);
  DemoDriver driver;
  driver.drive(ExtrinsicErrors::Zero(), 190, back);
  ASSERT_TRUE(driver.calibration().faults().none()) << "soon it is named";
  driver.cameras.reset(4);
  driver.drive(ExtrinsicErrors::Zero(), 100);
  driver.cameras.set(4);
  driver.drive(ExtrinsicErrors::Zero(), 400);
  EXPECT_TRUE(driver.calibration().faults().none());
}

TEST(OnlineCalibration, KeepsTheVerdictOfACameraThatComesBackAndStillContradicts) {
  const CameraMask back = CameraMask().set(4);
  DemoDriver driver;
  driver.drive(ExtrinsicErrors::Zero(), 250, back);
  driver.cameras.reset(4);
  driver.drive(ExtrinsicErrors::Zero(), 100);
  driver.cameras.set(4);
  driver.drive(ExtrinsicErrors::Zero(), 170, back);
  EXPECT_EQ(driver.calibration().contradicting(), back);
}

TEST(OnlineCalibration, KeepsTheFirstTwoCamerasLeftOutWhenAThirdIsNamed) {
  const CameraMask swapped = CameraMask().set(1).set(4);
  DemoDriver driver;
  driver.tracking = false;
  driver.drive(ExtrinsicErrors::Zero(), 250, swapped);
  ASSERT_EQ(driver.calibration().left_out(), swapped);
  driver.cameras = ~swapped;
  driver.drive(ExtrinsicErrors::Zero(), 900, CameraMask().set(0));
  EXPECT_TRUE(driver.calibration().faults()[0]);
  EXPECT_EQ(driver.calibration().left_out(), swapped);
}

TEST(OnlineCalibration, LearnsNoHeadingWhileACameraContradictsTheMap) {
  DemoDriver driver;
  driver.drive(ExtrinsicErrors::Zero(), 250, CameraMask().set(4));
  ASSERT_TRUE(driver.calibration().contradicting()[4]);
  const ExtrinsicErrors before = driver.calibration().filter().errors();
  driver.heading_against_motion_rad = radians(0.5);
  driver.drive(ExtrinsicErrors::Zero(), 150, CameraMask().set(4));
  EXPECT_EQ(driver.calibration().filter().errors(), before);
}

TEST(OnlineCalibration, JudgesNoCameraIfOnlyThreeAreUsed) {
  DemoDriver driver;
  driver.cameras = CameraMask().set(1).set(2).set(4);
  driver.drive(ExtrinsicErrors::Zero(), 600, CameraMask().set(4));
  EXPECT_TRUE(driver.calibration().faults().none());
}

TEST(OnlineCalibration, UsesTheCorrectionsOfTheStartOnceACameraContradictsTheMap) {
  DemoDriver driver;
  driver.drive(kSmallError, 500);
  ASSERT_NE(driver.calibration().used_errors(), ExtrinsicErrors::Zero());
  driver.drive(kSmallError, 300, CameraMask().set(4));
  ASSERT_TRUE(driver.calibration().contradicting()[4]);
  EXPECT_EQ(driver.calibration().used_errors(), ExtrinsicErrors::Zero());
}

}  // namespace
}  // namespace bevloc
