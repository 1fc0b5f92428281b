#include "evaluation/calib/calib_picture.h"

#include <gtest/gtest.h>

#include "common/files.h"
#include "common/image_file.h"
#include "sim/sim_rig.h"
#include "tests/support/png_size.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

TEST(CalibPicture, ACamerasNameCanBeReadOnABrightSky) {
  RecordedPicture picture;
  picture.camera = 1;
  picture.image = {64, 36, std::vector<uint8_t>(64UL * 36UL, 255)};
  std::vector<CalibrationView> views(1);
  views[0].rig = sim::nominal_rig();
  const HdMap map;
  const test::TemporaryFolder folder;
  const std::string file = folder / "calib.png";
  const Status written =
      write_calibration_picture(views, {picture}, ReferenceTrajectory({}), MapIndex(map), file);
  ASSERT_TRUE(written) << written.error().message;
  const test::SizePx size = test::png_size(read_file(file).value());
  RgbImage sheet(size.width, size.height);
  ASSERT_TRUE(read_image(file, sheet));
  // The title, which is dark, ends above the pictures.
  constexpr int kTopOfPictures_px = 40;
  int dark = 0;
  int yellow = 0;
  for (int row = kTopOfPictures_px; row < sheet.height; ++row) {
    for (int col = 0; col < sheet.width; ++col) {
      const uint8_t* rgb = sheet.view().row(row) + 3 * col;
      dark += rgb[0] < 60 && rgb[1] < 60 && rgb[2] < 60;
      yellow += rgb[0] > 200 && rgb[1] > 200 && rgb[2] < 60;
    }
  }
  EXPECT_GT(dark, 50);
  EXPECT_GT(yellow, 20);
}

}  // namespace
}  // namespace bevloc::evaluation
