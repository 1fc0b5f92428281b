// Tests the parts of the schema that test_schema.py does not see: passes, texts and the page.
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command/schema/json_schema.h"
#include "command/schema/page_texts.h"
#include "command/schema/schema_command.h"
#include "evaluation/drive/drive_config.h"
#include "tests/support/text.h"

namespace bevloc::command {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// A reader in which a word decides which keys exist, a key replaces another one, and a word is
/// excluded.
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

/// A reader in which the first word of `stock` rejects a section, and a word in the section decides
/// which keys the section has.
void read_garage(YamlMap& yaml) {
  const bool empty = yaml.require_choice<bool>("stock", {{"none", true}, {"cars", false}});
  auto lift = yaml.optional_map("lift");
  if (!lift) return;
  const bool by_motor =
      lift->optional_choice<bool>("drive", true, {{"motor", true}, {"hand", false}});
  if (by_motor) lift->require<double>("power_kw");
  if (empty) yaml.reject_key("lift", "a lift without cars", "no section lift");
}

TEST(Schema, FindsADecisionInASectionThatTheFirstWordRejects) {
  const auto schema = schema_of(read_garage, {"Garage", [](const std::string&) { return ""; }});
  const auto& lift = schema["properties"]["lift"];
  EXPECT_FALSE(lift.contains("required")) << lift;
  // Without `drive` the lift has a motor, too: the condition does not demand the key.
  EXPECT_EQ(lift["allOf"].dump(), R"([{"if":{"properties":{"drive":{"const":"motor"}}},)"
                                  R"("then":{"required":["power_kw"]},)"
                                  R"("else":{"properties":{"power_kw":false}}}])");
  EXPECT_THAT(schema["allOf"].dump(), HasSubstr(R"("else":{"properties":{"lift":false}})"));
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
  EXPECT_EQ(page.meaning("cat.fur"), "Its fur.");
  EXPECT_EQ(page.introduction("cat"), "A cat of some kind.");
  EXPECT_EQ(page.meaning("cat.age"), "");
  EXPECT_EQ(page.meaning("dog[].eye"), "both");
  EXPECT_EQ(page.meaning("dog[].tail.tip"), "the end");
  EXPECT_EQ(page.meaning("dog[].tip"), "");
}

TEST(PageTexts, FindsAKeyByItsWholePath) {
  const PageTexts page(
      "## `cat`\n\n| key | meaning |\n|---|---|\n| `name` | of the cat |\n| `toys` | list |\n\n"
      "Each entry of `toys`:\n\n| key | meaning |\n|---|---|\n| `name` | of a toy |\n\n"
      "Keys of the parts of `cat.body`:\n\n| key | meaning |\n|---|---|\n"
      "| `name` | of a part |\n| `paw.name` | of a paw |\n\n## `dog`\n\nText.\n");
  EXPECT_EQ(page.meaning("cat.name"), "of the cat");
  EXPECT_EQ(page.meaning("cat.toys[].name"), "of a toy");
  EXPECT_EQ(page.meaning("cat.body.tail.name"), "of a part");
  EXPECT_EQ(page.meaning("cat.body.leg.paw.name"), "of a paw");
  EXPECT_EQ(page.meaning("cat.owner.name"), "");
  EXPECT_EQ(page.meaning("dog.name"), "");
  EXPECT_EQ(page.introduction("cat"), "");
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
  const std::string page = test::read_text(BEVLOC_SOURCE_DIR "/docs/configuration.md");
  EXPECT_EQ(page, configuration_page());
  std::set<std::string> unknown;
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);) {
    const bool row = line.starts_with("| `");
    const bool section = line.starts_with("## `");
    if (!row && !section) continue;
    const size_t first = line.find('`') + 1;
    std::string key = line.substr(first, line.find('`', first) - first);
    key = key.substr(key.rfind('.') + 1);
    if (!keys.contains(key)) unknown.insert(key);
  }
  EXPECT_THAT(unknown, IsEmpty());
}

/// The schema of a key by its path, "simulation.street.seed".
const nlohmann::ordered_json& schema_at(const nlohmann::ordered_json& schema,
                                        const std::string& path) {
  const nlohmann::ordered_json* found = &schema;
  std::istringstream steps(path);
  for (std::string step; std::getline(steps, step, '.');) {
    if (found->contains("items")) found = &found->at("items");
    found = &found->at("properties").at(step);
  }
  return *found;
}

TEST(ConfigurationSchema, DescribesEachKeyAndNotAnotherOneOfItsName) {
  std::optional<evaluation::SimulationConfig> simulation;
  const auto reader = evaluation::simulation_reader(simulation);
  const auto schema = configuration_schema(&reader);
  const auto text = [&schema](const std::string& path) {
    return schema_at(schema, path).value("description", "");
  };
  EXPECT_EQ(text("can.vehicle.wheel_speed.signals.vehicle"),
            "Speed of the vehicle, in place of the rear wheels.");
  EXPECT_THAT(text("can.vehicle"), HasSubstr("in place of the VEH_ messages"));
  EXPECT_EQ(text("can.vehicle.yaw_rate.signal"), "The yaw rate.");
  EXPECT_EQ(text("can.vehicle.yaw_rate.negative.signal"),
            "In a condition such as valid or backward: the signal that is compared with values.");
  EXPECT_THAT(text("can.secoc.key_file"), HasSubstr("32 hexadecimal digits"));
  EXPECT_THAT(text("simulation.seed"), HasSubstr("the drive, the traffic"));
  EXPECT_THAT(text("simulation.street.seed"), HasSubstr("Determines the looks"));
  EXPECT_EQ(text("simulation.faults.seed"), "");
  EXPECT_THAT(text("calibration"), HasSubstr("of the six cameras"));
  EXPECT_THAT(text("calibration.online.file"), HasSubstr("across restarts"));
  EXPECT_TRUE(text("manifest").ends_with(".")) << text("manifest");
  EXPECT_THAT(text("gpio.trigger.chip"), HasSubstr("Label"));
  EXPECT_THAT(text("realtime.vision.cpus"), HasSubstr("may run"));
  EXPECT_THAT(text("cameras.controls.name"), HasSubstr("The control."));
  EXPECT_EQ(schema_at(schema, "health.max_yaw_sigma_deg").at("maximum").dump(), "1.5");
}

TEST(ConfigurationSchema, HasTheDefaultsOfListsAndWords) {
  std::optional<evaluation::SimulationConfig> simulation;
  const auto reader = evaluation::simulation_reader(simulation);
  const auto schema = configuration_schema(&reader);
  const auto text = [&schema](const std::string& path) {
    return schema_at(schema, path).value("default", nlohmann::ordered_json()).dump();
  };
  EXPECT_EQ(text("record.images"), R"("jpeg")");
  EXPECT_EQ(text("cameras.formats"), R"(["nv12","yuyv","uyvy"])");
  EXPECT_EQ(text("tracker.correction_correlation_m"), "[5,10,10]");
  EXPECT_EQ(text("simulation.stops_s"), "[2,7]");
  EXPECT_EQ(text("simulation.exposure_offsets_ms"), "[0,0,0,0,0,0]");
}

TEST(RigSchema, DescribesEveryKeyOfACamera) {
  const auto camera = schema_at(rig_schema(), "cameras.front");
  EXPECT_THAT(schema_at(camera, "fy_px").value("description", ""), HasSubstr("pinhole model"));
  EXPECT_THAT(schema_at(camera, "vehicle_from_camera.rotation_wxyz").value("description", ""),
              HasSubstr("unit quaternion"));
}

}  // namespace
}  // namespace bevloc::command
