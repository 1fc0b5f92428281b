#include "evaluation/drive/drive_report.h"

#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/text.h"

namespace bevloc::evaluation {
namespace {

TEST(DriveReportTest, ADriveWithoutAValidPoseHasNoErrors) {
  const DriveReport report;
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_TRUE(json["estimate"].is_null());
  EXPECT_TRUE(json["prior"].is_null());
  const std::string table = to_table(report);
  EXPECT_NE(table.find("never valid"), std::string::npos) << table;
  EXPECT_EQ(table.find("MAE"), std::string::npos) << table;
  EXPECT_NE(table.find("exposure to CAN    none\n"), std::string::npos) << table;
}

TEST(DriveReportTest, ShowsTheErrorsOfValidPoses) {
  DriveReport report;
  report.estimate.lateral_m.mae = 0.125;
  report.poses.emplace_back();
  EXPECT_EQ(nlohmann::json::parse(to_json(report))["estimate"]["lateral_m"]["mae"], 0.125);
  EXPECT_NE(to_table(report).find("0.125"), std::string::npos);
}

TEST(DriveReportTest, ThePageNamesEveryKeyOfTheJson) {
  const std::filesystem::path tree = BEVLOC_SOURCE_DIR;
  const std::string page = test::read_text(tree / "docs/simulation.md");
  DriveReport report;
  report.poses.emplace_back();  // so that the errors are there
  const auto json = nlohmann::json::parse(to_json(report)).flatten();
  for (const auto& [path, value] : json.items()) {
    std::istringstream keys(path.substr(1));  // such as estimate/lateral_m/mae
    for (std::string key; std::getline(keys, key, '/');) {
      EXPECT_NE(page.find('`' + key + '`'), std::string::npos) << key;
    }
  }
}

}  // namespace
}  // namespace bevloc::evaluation
