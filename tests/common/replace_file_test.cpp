#include "common/replace_file.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

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

TEST(ReplaceFile, KeepsTheModeOfTheFileAndOfItsBackup) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "rig.yaml";
  const std::filesystem::path backup = folder / "rig.yaml.bak";
  ASSERT_TRUE(write_file(file, "first"));
  for (const auto mode : {std::filesystem::perms{0640}, std::filesystem::perms{0600}}) {
    std::filesystem::permissions(file, mode);
    std::filesystem::remove(backup);
    ASSERT_TRUE(replace_file(file, "second"));
    EXPECT_EQ(std::filesystem::status(file).permissions(), mode);
    ASSERT_TRUE(replace_file_with_backup(file, "third"));
    EXPECT_EQ(std::filesystem::status(file).permissions(), mode);
    EXPECT_EQ(std::filesystem::status(backup).permissions(), mode);
  }
}

TEST(ReplaceFile, KeepsTheOwner) {
  constexpr uid_t kUser = 1234;
  constexpr gid_t kGroup = 2345;
  const test::TemporaryFolder folder;
  const std::string file = folder / "rig.yaml";
  ASSERT_TRUE(write_file(file, "first"));
  if (chown(file.c_str(), kUser, kGroup) != 0) GTEST_SKIP() << "needs root";
  ASSERT_TRUE(replace_file(file, "second"));
  struct stat found {};
  ASSERT_EQ(stat(file.c_str(), &found), 0);
  EXPECT_EQ(found.st_uid, kUser);
  EXPECT_EQ(found.st_gid, kGroup);
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
