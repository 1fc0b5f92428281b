// Tests that what was read of a file stays known when somebody changes the file.
#include "firmware/config/kept_files.h"

#include <gtest/gtest.h>

#include "firmware/runtime/identity.h"
#include "tests/firmware/config/config_fixture.h"

namespace bevloc::firmware {
namespace {

TEST(KeptFilesTest, ReturnsTheBytesOfTheTimeWhenTheyWereKept) {
  const test::TemporaryFolder folder;
  KeptFiles files;
  ASSERT_TRUE(write_file(folder / "kept", "old"));
  ASSERT_TRUE(write_file(folder / "other", "old"));
  files.keep(folder / "kept");
  files.keep(folder / "missing");
  for (const char* name : {"kept", "other", "missing"}) {
    ASSERT_TRUE(write_file(folder / name, "new"));
  }
  EXPECT_EQ(files.bytes_of(folder / "kept").value(), "old");
  EXPECT_EQ(files.bytes_of(folder / "other").value(), "new");
  EXPECT_EQ(files.bytes_of(folder / "missing").value(), "new");
  EXPECT_FALSE(files.bytes_of(folder / "gone"));
  EXPECT_FALSE(files.bytes_of(""));
}

using KeptConfigTest = ConfigTest;

TEST_F(KeptConfigTest, LoadingKeepsConfigurationAndRig) {
  write("rig.yaml", "old");
  const auto config = load(kSmallest);
  ASSERT_TRUE(config) << config.error().message;
  const can::Identity before = identity_of(*config, {});
  write("rig.yaml", "new");
  write("test.yaml", "new");
  EXPECT_EQ(config->kept_files.bytes_of(config->file).value(), kSmallest);
  EXPECT_EQ(config->kept_files.bytes_of(config->rig_file).value(), "old");
  const can::Identity after = identity_of(*config, {});
  EXPECT_EQ(after.configuration, before.configuration);
  EXPECT_EQ(after.rig, before.rig);
}

}  // namespace
}  // namespace bevloc::firmware
