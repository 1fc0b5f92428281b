// Runs the program bevloc_convert_map.
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "common/files.h"
#include "pipeline/map/map_binary.h"
#include "pipeline/map/map_checksum.h"
#include "pipeline/map/map_loader.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

const std::filesystem::path kStreet =
    std::filesystem::path(BEVLOC_SOURCE_DIR) / "tests/pipeline/map/fixtures/street.osm";

class ConvertMapTest : public testing::Test {
 protected:
  /// Returns the exit code.
  static int convert(const std::filesystem::path& in, const std::filesystem::path& out) {
    const std::string command =
        std::string(BEVLOC_CONVERT_MAP_PROGRAM) + " " + in.string() + " " + out.string();
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  const test::TemporaryFolder folder_;
};

TEST_F(ConvertMapTest, ConvertsALanelet2MapWithMillimetreAccuracy) {
  ASSERT_EQ(convert(kStreet, folder_ / "street.bvm"), 0);
  const HdMap map = load_map(kStreet).value();
  const HdMap again = load_map(folder_ / "street.bvm").value();
  EXPECT_EQ(again.name, map.name);
  EXPECT_EQ(again.lanes.size(), map.lanes.size());
  EXPECT_EQ(map_checksum(again), map_checksum(map)) << "one map, two formats";
  ASSERT_EQ(again.elements.size(), map.elements.size());
  for (size_t i = 0; i < map.elements.size(); ++i) {
    EXPECT_EQ(again.elements[i].element_class, map.elements[i].element_class);
    EXPECT_EQ(again.elements[i].appearance, map.elements[i].appearance);
    ASSERT_EQ(again.elements[i].points.size(), map.elements[i].points.size());
    for (size_t k = 0; k < map.elements[i].points.size(); ++k) {
      EXPECT_LE((again.elements[i].points[k] - map.elements[i].points[k]).norm(), kMapQuantumM);
    }
  }
}

TEST_F(ConvertMapTest, ExitsWithTwoAndWritesNothingOnBadInput) {
  EXPECT_EQ(convert(folder_ / "none.osm", folder_ / "out.bvm"), 2);
  EXPECT_EQ(
      convert(std::filesystem::path(BEVLOC_SOURCE_DIR) / "CMakeLists.txt", folder_ / "out.bvm"), 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.bvm"));
  EXPECT_EQ(convert(kStreet, folder_ / "no_folder/out.bvm"), 2);
  EXPECT_EQ(convert(kStreet, ""), 2);
  EXPECT_EQ(convert(kStreet, folder_ / "out.osm"), 2) << "only .bvm";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.osm"));
}

TEST_F(ConvertMapTest, WritesOverNoFileThatItReads) {
  ASSERT_EQ(convert(kStreet, folder_ / "street.bvm"), 0);
  std::filesystem::create_hard_link(folder_ / "street.bvm", folder_ / "same.bvm");
  EXPECT_EQ(convert(folder_ / "street.bvm", folder_ / "same.bvm"), 2);
  std::filesystem::copy_file(kStreet, folder_ / "copy.bvm");
  EXPECT_EQ(convert(folder_ / "copy.bvm", folder_ / "copy.bvm"), 2);
  EXPECT_EQ(read_file(folder_ / "copy.bvm").value(), read_file(kStreet).value());
}

}  // namespace
}  // namespace bevloc
