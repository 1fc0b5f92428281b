#include "evaluation/drive/sheet.h"

#include <string>

#include <gtest/gtest.h>

#include "common/files.h"
#include "common/image_file.h"
#include "pipeline/map/rasterizer.h"
#include "sim/sim_rig.h"
#include "tests/support/png_size.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::evaluation {
namespace {

/// A crossing that lies 6 to 10 m before a vehicle at the origin.
HdMap map_with_crossing() {
  HdMap map;
  map.elements = {{ElementClass::kPedestrianCrossing,
                   Appearance::kZebra,
                   {{6.0, -3.0}, {10.0, -3.0}, {10.0, 3.0}, {6.0, 3.0}}}};
  return map;
}

/// The upper half of a sheet with six grey pictures. It shows the pictures with the map over them.
Pixels pictures_of_sheet(const Se2& pose, const Se2& reference_from_exposure) {
  const Rig rig = sim::nominal_rig();
  SheetContent content;
  for (size_t i = 0; i < kCameraCount; ++i) {
    const Intrinsics& lens = rig.cameras[i].intrinsics;
    content.images[i] = RgbImage(lens.width_px, lens.height_px);
  }
  content.present.set();
  content.reference_from_exposure.fill(reference_from_exposure);
  content.prior = content.corrected = content.matched_at = pose;
  content.mask_logits.assign(kRasterSize, -5.0F);
  for (auto* of : {&content.solution.x_probability, &content.solution.y_probability,
                   &content.solution.yaw_probability}) {
    of->assign(3, 1.0F / 3.0F);
  }
  const test::TemporaryFolder folder;
  const std::string file = (folder / "sheet.png").string();
  const HdMap map = map_with_crossing();
  const Status written = write_sheet(content, rig, MapIndex(map), file);
  EXPECT_TRUE(written) << written.error().message;
  const test::SizePx size = test::png_size(read_file(file).value());
  RgbImage sheet(size.width, size.height);
  EXPECT_TRUE(read_image(file, sheet));
  sheet.pixels.resize(sheet.pixels.size() / 2);
  return sheet.pixels;
}

TEST(Sheet, DrawsTheMapFromWhereEachCameraExposed) {
  const Se2 pose{0.5, -0.2, 0.1};
  const Se2 motion{-1.5, 0.1, 0.05};
  const Pixels moved = pictures_of_sheet(pose, motion);
  EXPECT_TRUE(moved == pictures_of_sheet(pose * motion, {}));
  EXPECT_FALSE(moved == pictures_of_sheet(pose, {}));
}

}  // namespace
}  // namespace bevloc::evaluation
