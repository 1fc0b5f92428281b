#include "evaluation/calib/calib_report.h"

#include <cmath>

#include <gmock/gmock.h>

#include "common/json_dump.h"

namespace bevloc::evaluation {
namespace {

using testing::HasSubstr;
using testing::Not;

CalibrationCheck check_of(const RigRefinement& refinement) {
  return {refinement, "pictures", CameraMask().set()};
}

/// A refinement in which each camera found most of its paint.
RigRefinement clear_refinement() {
  RigRefinement refinement;
  refinement.frames = 10;
  for (CameraRefinement& camera : refinement.cameras) {
    camera.looked_at = 200;
    camera.found = 180;
    camera.sigma.setConstant(1e-3);
  }
  return refinement;
}

TEST(CalibReport, SaysWhichParametersWereKept) {
  RigRefinement refinement = clear_refinement();
  for (CameraRefinement& camera : refinement.cameras) camera.kept.set(kFocal);
  EXPECT_THAT(text_of(refinement), HasSubstr(" kept"));
  const nlohmann::json json = json_of(refinement);
  const std::string focal(kCameraParameterInfos[kFocal].key);
  const nlohmann::json& front = json["cameras"]["front"];
  EXPECT_EQ(front["kept"], nlohmann::json::array({focal}));
  EXPECT_FALSE(front["change"].contains(focal));
  EXPECT_THAT(text_of(check_of(refinement)), Not(HasSubstr("kept")));
}

TEST(CalibReport, SaysATimeOffsetThatWasFound) {
  RigRefinement refinement = clear_refinement();
  EXPECT_EQ(time_offsets_of(refinement), "") << "0 ms with a sigma of 1 ms";
  refinement.cameras[1].change[kTimeOffset] = -0.02;
  EXPECT_THAT(time_offsets_of(refinement),
              testing::StartsWith("front: pictures are taken 20.0 ms earlier than"));
  for (CameraRefinement& camera : refinement.cameras) {
    camera.change[kTimeOffset] = camera.sigma[kTimeOffset] = 0.0;
  }
  for (size_t c = 0; c < 3; ++c) refinement.cameras[c].kept.set(kTimeOffset);
  for (size_t c = 3; c < kCameraCount; ++c) refinement.cameras[c].unobservable.set(kTimeOffset);
  EXPECT_EQ(time_offsets_of(refinement), "") << "none was looked for or found";
}

TEST(CalibReport, ACameraWhoseRotationIsNotObservableIsNotGood) {
  RigRefinement checked = clear_refinement();
  EXPECT_TRUE(all_good(check_of(checked)));
  checked.cameras[1].unobservable.set(kPitch);
  EXPECT_FALSE(all_good(check_of(checked)));
  EXPECT_EQ(verdict_on(checked.cameras[1], 0.9), CameraVerdict::kTooLittle);
  EXPECT_THAT(text_of(check_of(checked)), HasSubstr("not observable"));
}

TEST(CalibReport, ACameraWithoutPicturesDoesNotCount) {
  CalibrationCheck check = check_of(clear_refinement());
  CameraRefinement& back = check.refinement.cameras[4];
  back.looked_at = back.found = 0;
  EXPECT_FALSE(all_good(check)) << "it has pictures, but they show nothing";
  check.recorded.reset(4);
  EXPECT_TRUE(all_good(check));
  EXPECT_THAT(text_of(check), HasSubstr("no pictures: the folder pictures/back is missing\n"));
  EXPECT_EQ(json_of(check)["cameras"]["back"]["verdict"], "no pictures");
  check.refinement.cameras[1].change[kYaw] = 0.01;
  EXPECT_FALSE(all_good(check)) << "another camera is off";
  check = check_of(clear_refinement());
  check.recorded.reset();
  EXPECT_FALSE(all_good(check));
}

TEST(CalibReport, ACameraThatIsTurnedIsOff) {
  RigRefinement checked = clear_refinement();
  checked.cameras[4].change[kYaw] = 0.01;
  EXPECT_EQ(verdict_on(checked.cameras[4], 0.9), CameraVerdict::kOff);
  checked.cameras[4].found = 20;
  checked.cameras[4].change.setZero();
  EXPECT_EQ(verdict_on(checked.cameras[4], 0.9), CameraVerdict::kMismatch);
}

TEST(CalibReport, NothingFoundIsAMismatchAndNotADistanceOfZero) {
  RigRefinement checked = clear_refinement();
  for (CameraRefinement& camera : checked.cameras) {
    camera.found = 0;
    camera.before_px = camera.after_px = std::nan("");
  }
  EXPECT_EQ(verdict_on(checked.cameras[0], 0.0), CameraVerdict::kMismatch);
  EXPECT_THAT(text_of(checked), HasSubstr("- -> -"));
  EXPECT_EQ(dump_json(json_of(check_of(checked))["cameras"]["front"]["before_px"], 2), "null");
}

}  // namespace
}  // namespace bevloc::evaluation
