// Whether a model and a rig belong together.
#include "pipeline/network/model/model_rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/network/model/load_error.h"
#include "pipeline/network/model/onnx_reader.h"
#include "sim/sim_rig.h"

namespace bevloc {
namespace {

using testing::HasSubstr;

nn::Graph shipped() {
  return nn::read_onnx(BEVLOC_SOURCE_DIR "/models/nano.onnx");
}

std::string error_of(const nn::Graph& graph) {
  try {
    read_model_rig(graph);
  } catch (const nn::LoadError& error) {
    return error.what();
  }
  return "";
}

/// A model that was trained on one rig.
nn::Graph without_ranges() {
  nn::Graph graph = shipped();
  graph.metadata.erase("bevloc.rig.focal_range_px");
  graph.metadata.erase("bevloc.rig.height_range_m");
  return graph;
}

std::string error_for(const Rig& rig, const nn::Graph& graph) {
  const Status fits = check_rig_fits(read_model_rig(graph), rig);
  return fits ? "" : fits.error().message;
}

TEST(ModelRig, TheShippedModelFitsTheDemoRig) {
  const ModelRig model = read_model_rig(shipped());
  ASSERT_TRUE(model.focal_px && model.height_m);
  EXPECT_NEAR((*model.focal_px)[1], 253.3, 0.1);
  EXPECT_EQ((*model.height_m)[4], 1.579);
  EXPECT_EQ(error_for(sim::nominal_rig(), shipped()), "");
}

TEST(ModelRig, AModelThatStatesNothingFitsEveryRig) {
  nn::Graph graph = shipped();
  std::erase_if(graph.metadata,
                [](const auto& entry) { return entry.first.find(".rig.") != entry.first.npos; });
  Rig rig = sim::nominal_rig();
  for (CameraModel& camera : rig.cameras) camera.intrinsics.fx_px *= 3.0;
  EXPECT_TRUE(check_rig_fits(read_model_rig(graph), rig));
}

TEST(ModelRig, ARangeOfTrainingAllowsMoreThanTheFactor) {
  nn::Graph graph = without_ranges();
  graph.metadata["bevloc.rig.focal_range_px"] = "92 343";
  graph.metadata["bevloc.rig.height_range_m"] = "0.6 2.6";
  const ModelRig model = read_model_rig(graph);
  Rig rig = sim::nominal_rig();
  for (CameraModel& camera : rig.cameras) camera.vehicle_from_camera.translation_m.z() = 2.5;
  rig.cameras[3].intrinsics.fx_px *= 0.4;
  EXPECT_TRUE(check_rig_fits(model, rig));
  rig.cameras[3].intrinsics.fx_px *= 5.0;
  EXPECT_THAT(check_rig_fits(model, rig).error().message, HasSubstr("wanted 92 to"));
  graph.metadata["bevloc.rig.height_range_m"] = "2.6 0.6";
  EXPECT_THAT(error_of(graph), HasSubstr("wanted the least value first"));
}

TEST(ModelRig, RefusesCamerasOfAnotherWidthOfView) {
  for (const double factor : {0.6, 1.6}) {
    Rig rig = sim::nominal_rig();
    rig.cameras[3].intrinsics.fx_px *= factor;
    EXPECT_THAT(error_for(rig, without_ranges()),
                HasSubstr("camera back_left: found a focal length in pixels of 320 "
                          "columns of"));
  }
  Rig alike = sim::nominal_rig();
  for (CameraModel& camera : alike.cameras) camera.intrinsics.fx_px *= 1.4;
  EXPECT_EQ(error_for(alike, without_ranges()), "");
}

TEST(ModelRig, RefusesCamerasOfAnotherHeight) {
  Rig rig = sim::nominal_rig();
  rig.cameras[1].vehicle_from_camera.translation_m.z() = 2.8;
  EXPECT_THAT(error_for(rig, without_ranges()),
              HasSubstr("camera front: found a height in metres of 2.8 in the rig, wanted 1.01 to "
                        "2.27, because the model was trained with 1.51"));
}

TEST(ModelRig, RefusesAModelForOtherCameras) {
  nn::Graph graph = shipped();
  graph.metadata["bevloc.rig.cameras"] = "front front_left front_right back_left back back_right";
  EXPECT_THAT(error_of(graph), HasSubstr("metadata 'bevloc.rig.cameras' is 'front front_left"));
  graph = shipped();
  graph.metadata["bevloc.rig.image_size_px"] = "640 192";
  EXPECT_THAT(error_of(graph), HasSubstr("is '640 192', wanted '320 96'"));
}

TEST(ModelRig, RefusesStatementsThatAreNoNumbers) {
  for (const char* const text : {"", "1 2 3 4 5", "1 2 3 4 5 6 7", "1 2 3 4 5 x", "1 2 3 4 5 -6",
                                 "1 2 3 4 5 nan", "1  2 3 4 5 6", "1 2 3 4 5 6 "}) {
    nn::Graph graph = shipped();
    graph.metadata["bevloc.rig.height_m"] = text;
    EXPECT_THAT(error_of(graph), HasSubstr("wanted 6 positive numbers")) << text;
  }
}

}  // namespace
}  // namespace bevloc
