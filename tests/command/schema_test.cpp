// Tests the parts of the schema that test_schema.py does not see: passes, texts and the page.
#include <fstream>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command/schema/json_schema.h"
#include "command/schema/page_texts.h"
#include "command/schema/schema_command.h"
#include "evaluation/drive/drive_config.h"

namespace bevloc::command {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// A reader with a word that decides, a key in place of another one, and a word that is excluded.
void read_shop(YamlMap& yaml) {
  const bool sells = yaml.require_choice<bool>("what", {{"sells", true}, {"rents", false}});
  if (sells) yaml.require<double>("price", more_than(0.0));
  if (!sells) yaml.optional<int>("days", 3, between(1, 30));
  YamlMap place = yaml.require_map("place");
  if (place.has_in_place_of("street")) {
    place.require<std::string>("street");
  } else {
    place.require<std::string>("box");
  }
  const bool open = yaml.optional_choice<bool>("door", true, {{"open", true}, {"shut", false}});
  if (!open && sells) yaml.reject_word("door", "shut while it sells", "open");
}

nlohmann::ordered_json shop_schema() {
  return schema_of(read_shop, {"Shop", [](const std::string& path) { return "about " + path; }});
}

TEST(Schema, SaysWhatEachWordNeeds) {
  const auto schema = shop_schema();
  EXPECT_EQ(schema["required"], (nlohmann::ordered_json{"what", "place"}));
  EXPECT_EQ(schema["additionalProperties"], false);
  EXPECT_EQ(schema["properties"]["price"]["exclusiveMinimum"], 0.0);
  EXPECT_EQ(schema["properties"]["days"]["default"], 3);
  EXPECT_EQ(schema["properties"]["door"]["default"], "open");
  EXPECT_EQ(schema["properties"]["place"]["properties"]["box"]["description"], "about place.box");
  const std::string rules = schema["allOf"].dump();
  EXPECT_THAT(rules, HasSubstr(R"("then":{"required":["price"]})"));
  EXPECT_THAT(rules, HasSubstr(R"({"properties":{"door":{"not":{"const":"shut"}}}})"));
}

TEST(Schema, AReaderStillReadsFilesAsBefore) {
  auto good = YamlMap::parse("what: sells\nprice: 3\nplace: {box: 7}\n", "shop.yaml");
  read_shop(*good);
  EXPECT_TRUE(good->finish()) << good->finish().error().message;
  auto bad = YamlMap::parse("what: sells\nprice: 3\nplace: {box: 7}\ndoor: shut\n", "shop.yaml");
  read_shop(*bad);
  ASSERT_FALSE(bad->finish());
  EXPECT_EQ(bad->finish().error().message,
            "shop.yaml:4: door: found shut while it sells, wanted open");
}

TEST(PageTexts, TakesMeaningsFromTables) {
  const PageTexts page(
      "# Page\n\n## `cat`\n\nOptional. A [cat](x.md) of\nsome kind.\n\nMore.\n\n"
      "| key | values | meaning |\n|---|---|---|\n| `fur` | a | Its `fur`. |\n\n"
      "| key | default |\n|---|---|\n| `age` | 3 |\n\n## dogs\n\n"
      "| key | meaning |\n|---|---|\n| `ear`, `eye` | both |\n| `tail.tip` | the end |\n");
  EXPECT_EQ(page.meaning("cat", "fur"), "Its fur.");
  EXPECT_EQ(page.introduction("cat"), "A cat of some kind.");
  EXPECT_EQ(page.meaning("cat", "age"), "");
  EXPECT_EQ(page.meaning("", "eye"), "both");
  EXPECT_EQ(page.meaning("dogs", "tip"), "the end");
  EXPECT_EQ(page.meaning("dogs", "fur"), "");
}

/// The last names of all keys of a schema.
void collect(const nlohmann::ordered_json& schema, std::set<std::string>& names) {
  if (!schema.contains("properties")) {
    if (schema.contains("items")) collect(schema["items"], names);
    return;
  }
  for (const auto& [name, inner] : schema["properties"].items()) {
    names.insert(name);
    collect(inner, names);
  }
}

TEST(ConfigurationSchema, HasEveryKeyOfThePage) {
  std::optional<evaluation::SimulationConfig> simulation;
  const auto reader = evaluation::simulation_reader(simulation);
  std::set<std::string> keys;
  collect(configuration_schema(&reader), keys);
  EXPECT_GT(keys.size(), 80U);
  std::ifstream file(std::string(BEVLOC_SOURCE_DIR) + "/docs/configuration.md");
  std::ostringstream page;
  page << file.rdbuf();
  EXPECT_EQ(page.str(), configuration_page());
  std::set<std::string> unknown;
  std::istringstream lines(page.str());
  for (std::string line; std::getline(lines, line);) {
    const bool row = line.starts_with("| `");
    const bool section = line.starts_with("## `");
    if (!row && !section) continue;
    const size_t first = line.find('`') + 1;
    const std::string key = line.substr(first, line.find('`', first) - first);
    if (!keys.contains(key)) unknown.insert(key);
  }
  EXPECT_THAT(unknown, IsEmpty());
}

}  // namespace
}  // namespace bevloc::command
