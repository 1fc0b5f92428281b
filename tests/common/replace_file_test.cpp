#include "common/replace_file.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "common/files.h"
#include "tests/support/temporary_folder.h"

namespace bevloc {
namespace {

TEST(ReplaceFile, KeepsEachEarlierContentUnderANameOfItsOwn) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = std::filesystem::path(folder.path()) / "rig.yaml";
  for (const char* content : {"first", "second", "third"}) {
    const Status status = replace_file_with_backup(file, content);
    ASSERT_TRUE(status) << status.error().message;
    EXPECT_EQ(*read_file(file), content);
  }
  EXPECT_EQ(*read_file(file.string() + ".bak"), "first");
  EXPECT_EQ(*read_file(file.string() + ".bak2"), "second");
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".bak3"));
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".new"));
}

TEST(ReplaceFile, LeavesTheOldFileWhereItCannotWrite) {
  const test::TemporaryFolder folder;
  const std::filesystem::path missing = std::filesystem::path(folder.path()) / "no" / "rig.yaml";
  const Status status = replace_file(missing, "text");
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().message.find("rig.yaml.new"), std::string::npos);
}

TEST(ReplaceFile, KeepsDevicesAndFolders) {
  const test::TemporaryFolder folder;
  for (const std::filesystem::path& path : {std::filesystem::path("/dev/full"), folder.path()}) {
    for (const Status& status :
         {replace_file(path, "text"), replace_file_with_backup(path, "text")}) {
      ASSERT_FALSE(status) << path;
      EXPECT_EQ(status.error().message,
                path.string() + ": found a folder or a device, wanted a file to replace, or none");
    }
  }
}

}  // namespace
}  // namespace bevloc
