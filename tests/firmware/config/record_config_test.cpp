// Tests the section `record` of the configuration.
#include "firmware/config/record_config.h"

#include <gmock/gmock.h>

namespace bevloc::firmware {
namespace {

std::pair<std::optional<RecordConfig>, std::string> read_recording(const std::string& section) {
  auto yaml = YamlMap::parse(section, "test");
  EXPECT_TRUE(yaml) << yaml.error().message;
  auto config = read_record(*yaml, "/etc/bevloc");
  const Status finished = yaml->finish();
  return {config, finished ? "" : finished.error().message};
}

TEST(RecordConfigTest, RecordsNothingByDefault) {
  EXPECT_FALSE(read_record(std::nullopt, "/etc/bevloc"));
}

TEST(RecordConfigTest, EveryKeyIsRead) {
  const auto [config, error] = read_recording(
      "{directory: ring, images: raw, jpeg_quality: 70, file_s: 20, max_mb: 500, max_age_h: 2, "
      "black_box_files: 5}");
  EXPECT_EQ(error, "");
  ASSERT_TRUE(config);
  EXPECT_EQ(config->directory, "/etc/bevloc/ring");
  EXPECT_EQ(config->images, RecordedImages::kRaw);
  EXPECT_EQ(config->jpeg_quality, 70);
  EXPECT_EQ(config->file_length, std::chrono::seconds(20));
  EXPECT_EQ(config->max_bytes, 500'000'000U);
  EXPECT_EQ(config->max_age, std::chrono::hours(2));
  EXPECT_EQ(config->black_box_files, 5);
}

TEST(RecordConfigTest, BadValuesAreRefusedByKey) {
  EXPECT_THAT(read_recording("{images: png, directory: a}").second,
              testing::HasSubstr("images: found png, wanted"));
  EXPECT_THAT(read_recording("{images: jpeg}").second, testing::HasSubstr("directory"));
  EXPECT_THAT(read_recording("{directory: a, file_s: 0}").second, testing::HasSubstr("file_s"));
}

}  // namespace
}  // namespace bevloc::firmware
