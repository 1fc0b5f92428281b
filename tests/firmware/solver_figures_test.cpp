#include "firmware/evaluation/solver_figures.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace bevloc::evaluation {
namespace {

namespace fs = std::filesystem;

/// A folder of its own, which ends with the test.
class SolverFiguresTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  /// Share of the pixels that are not paper; none where the file is no picture of this size.
  static double ink_of(const fs::path& file, const cv::Size& size) {
    const cv::Mat picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
    EXPECT_EQ(picture.size(), size) << file;
    if (picture.size() != size) return 0.0;
    return static_cast<double>(cv::countNonZero(picture < 250)) / size.area();
  }

  fs::path folder_ = fs::path(testing::TempDir()) /
                     (std::string("bevloc_figures_") +
                      testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(SolverFiguresTest, DrawsThreePicturesIntoANewFolder) {
  const Status status = draw_solver_figures(0, (folder_ / "new").string());
  ASSERT_TRUE(status) << status.error().message;
  for (const auto& [name, size] : {std::pair("solver_spectra.png", cv::Size(1860, 868)),
                                   std::pair("solver_axis_features.png", cv::Size(1464, 888)),
                                   std::pair("solver_distributions.png", cv::Size(1568, 1212))}) {
    EXPECT_GT(ink_of(folder_ / "new" / name, size), 0.03) << name;
  }
}

TEST_F(SolverFiguresTest, SaysWhichFolderCannotBeMade) {
  const fs::path file = folder_ / "file";
  std::ofstream(file) << "not a folder";
  const Status status = draw_solver_figures(0, (file / "below").string());
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, testing::HasSubstr(file.string()));
}

}  // namespace
}  // namespace bevloc::evaluation
