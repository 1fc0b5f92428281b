#include "common/strict_yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bevloc {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

YamlMap parsed(const std::string& text) {
  auto yaml = YamlMap::parse(text, "t.yaml");
  EXPECT_TRUE(yaml.has_value()) << yaml.error().message;
  return *yaml;
}

std::string parse_error(const std::string& text) {
  const auto yaml = YamlMap::parse(text, "t.yaml");
  EXPECT_FALSE(yaml.has_value());
  return yaml ? "" : yaml.error().message;
}

std::string finish_error(const YamlMap& yaml) {
  const Status status = yaml.finish();
  EXPECT_FALSE(status.has_value());
  return status ? "" : status.error().message;
}

template <typename T>
std::string require_error(const std::string& text, const Wanted<T>& wanted = {}) {
  YamlMap yaml = parsed(text);
  EXPECT_EQ(yaml.require<T>("key", wanted), T{});
  return finish_error(yaml);
}

TEST(StrictYaml, ReadsEveryType) {
  YamlMap yaml = parsed(
      "flag: true\nsmall: -7\nlarge: -9000000000\nid: 0x1F\nmask: 18446744073709551615\n"
      "length: 1.5e-3\nname: front left\nquoted: \"12\"\nlist: [1, 2, 3.5]\n");
  EXPECT_TRUE(yaml.require<bool>("flag"));
  EXPECT_EQ(yaml.require<int>("small"), -7);
  EXPECT_EQ(yaml.require<int64_t>("large"), -9000000000);
  EXPECT_EQ(yaml.require<uint32_t>("id"), 31U);
  EXPECT_EQ(yaml.require<uint64_t>("mask"), UINT64_MAX);
  EXPECT_EQ(yaml.require<double>("length"), 1.5e-3);
  EXPECT_EQ(yaml.require<std::string>("name"), "front left");
  EXPECT_EQ(yaml.require<std::string>("quoted"), "12");
  EXPECT_THAT(yaml.require_list<double>("list", 3), ElementsAre(1.0, 2.0, 3.5));
  EXPECT_TRUE(yaml.finish().has_value());
}

TEST(StrictYaml, OptionalValuesFallBackOnlyWhenTheyAreNotThere) {
  YamlMap yaml = parsed("there: 2\n");
  EXPECT_EQ(yaml.optional<int>("there", 5), 2);
  EXPECT_EQ(yaml.optional<int>("absent", 5), 5);
  EXPECT_FALSE(yaml.optional_map("no_map").has_value());
  EXPECT_TRUE(yaml.finish().has_value());

  YamlMap wrong = parsed("there: two\n");
  wrong.optional<int>("there", 5);
  EXPECT_EQ(finish_error(wrong), "t.yaml:1: there: found two, wanted a whole number");
}

TEST(StrictYaml, NamesFileLineKeyFoundAndWanted) {
  YamlMap yaml = parsed("camera:\n  front:\n    fx_px: -3\n");
  YamlMap front = yaml.require_map("camera").require_map("front");
  EXPECT_EQ(front.require<double>("fx_px", more_than(0.0)), 0.0);
  EXPECT_EQ(finish_error(yaml),
            "t.yaml:3: camera.front.fx_px: found -3, wanted a number, more than 0");
}

TEST(StrictYaml, RefusesValuesOfAnotherType) {
  EXPECT_EQ(require_error<int>("key: 0x-5"), "t.yaml:1: key: found 0x-5, wanted a whole number");
  EXPECT_THAT(require_error<double>("key: fast"), HasSubstr("found fast, wanted a number"));
  EXPECT_THAT(require_error<double>("key: .nan"), HasSubstr("found .nan"));
  EXPECT_THAT(require_error<double>("key: nan"), HasSubstr("found nan"));
  EXPECT_THAT(require_error<double>("key: inf"), HasSubstr("found inf"));
  EXPECT_THAT(require_error<double>("key: 1e999"), HasSubstr("found 1e999"));
  EXPECT_THAT(require_error<double>("key: 1.5 m"), HasSubstr("found 1.5 m"));
  EXPECT_THAT(require_error<double>("key: \"1.5\""), HasSubstr("found \"1.5\""));
  EXPECT_THAT(require_error<double>("key:"), HasSubstr("found nothing"));
  EXPECT_THAT(require_error<int>("key: 1.5"), HasSubstr("wanted a whole number"));
  EXPECT_THAT(require_error<int>("key: 3000000000"), HasSubstr("found 3000000000"));
  EXPECT_THAT(require_error<uint32_t>("key: -1"), HasSubstr("found -1"));
  EXPECT_THAT(require_error<bool>("key: yes"), HasSubstr("wanted true or false"));
  EXPECT_THAT(require_error<std::string>("key: [a]"), HasSubstr("found a list of 1"));
  EXPECT_THAT(require_error<int>("key: {a: 1}"), HasSubstr("found a mapping"));
}

TEST(StrictYaml, ChecksLimits) {
  EXPECT_THAT(require_error<int>("key: 0", at_least(1)),
              EndsWith("wanted a whole number, at least 1"));
  EXPECT_THAT(require_error<int>("key: 9", between(1, 8)), EndsWith("1 to 8"));
  EXPECT_EQ(parsed("key: 8").require<int>("key", between(1, 8)), 8);
  EXPECT_EQ(parsed("key: 1").require<int>("key", at_least(1)), 1);
}

TEST(StrictYaml, ReportsAMissingKeyAndTheMisspeltOneBesideIt) {
  YamlMap yaml = parsed("rig:\n  fx_mm: 3\n");
  yaml.require_map("rig").require<double>("fx_px");
  EXPECT_EQ(finish_error(yaml),
            "t.yaml:1: rig.fx_px: found no such key, wanted a number "
            "(line 2 has an unknown key fx_mm)");
}

TEST(StrictYaml, ReportsUnknownKeysAtAnyDepth) {
  YamlMap yaml = parsed("a: 1\nb:\n  c: 2\n  d: 3\n");
  yaml.require<int>("a");
  yaml.require_map("b").require<int>("c");
  EXPECT_THAT(finish_error(yaml), StartsWith("t.yaml:4: b.d: found an unknown key"));
}

TEST(StrictYaml, ReportsAKeyThatIsThereTwice) {
  YamlMap yaml = parsed("a: 1\nb: 2\na: 3\n");
  yaml.require<int>("a");
  yaml.require<int>("b");
  EXPECT_EQ(finish_error(yaml),
            "t.yaml:3: a: found the key a second time (the first is in line 1), "
            "wanted each key once");
}

TEST(StrictYaml, TheFirstMistakeWins) {
  YamlMap yaml = parsed("a: x\nb: y\n");
  yaml.require<int>("a");
  yaml.require<int>("b");
  yaml.reject("b", "something", "else");
  EXPECT_THAT(finish_error(yaml), StartsWith("t.yaml:1: a:"));
}

TEST(StrictYaml, PassesTheErrorOfAnotherFileOn) {
  YamlMap yaml = parsed("a: x.dbc\n");
  yaml.require<std::string>("a");
  yaml.reject_file(Error{"x.dbc:3: found X, wanted Y"});
  yaml.reject("a", "something", "else");
  EXPECT_EQ(finish_error(yaml), "x.dbc:3: found X, wanted Y");
}

TEST(StrictYaml, ChecksListsItemByItem) {
  YamlMap yaml = parsed("list:\n  - 1\n  - 2\n  - x\n");
  EXPECT_EQ(yaml.require_list<int>("list").size(), 3U);
  EXPECT_EQ(finish_error(yaml), "t.yaml:4: list[2]: found x, wanted a whole number");

  YamlMap shorter = parsed("list: [1, 2]\n");
  EXPECT_EQ(shorter.require_list<double>("list", 3).size(), 3U);
  EXPECT_THAT(finish_error(shorter), EndsWith("found a list of 2, wanted a list of 3"));

  YamlMap scalar = parsed("list: 1\n");
  scalar.require_list<double>("list");
  EXPECT_THAT(finish_error(scalar), EndsWith("found 1, wanted a list"));

  YamlMap limited = parsed("list: [1, -2]\n");
  limited.require_list<int>("list", 2, at_least(0));
  EXPECT_THAT(finish_error(limited), HasSubstr("list[1]: found -2"));
}

TEST(StrictYaml, OptionalListsFallBackOnlyWhenTheyAreNotThere) {
  YamlMap yaml = parsed("there: [3, 4]\n");
  EXPECT_THAT(yaml.optional_list<int>("there", {1, 2}, 2), ElementsAre(3, 4));
  EXPECT_THAT(yaml.optional_list<int>("absent", {1, 2}, 2), ElementsAre(1, 2));
  EXPECT_TRUE(yaml.finish().has_value());

  YamlMap wrong = parsed("there: [3]\n");
  EXPECT_EQ(wrong.optional_list<int>("there", {1, 2}, 2).size(), 2U);
  EXPECT_EQ(finish_error(wrong), "t.yaml:1: there: found a list of 1, wanted a list of 2");
}

TEST(StrictYaml, ARecordingKeepsTheDefaultOfAList) {
  YamlRecording recording;
  YamlMap yaml = YamlMap::record(recording);
  EXPECT_THAT(yaml.optional_list<double>("list", {5.0, 0.1}, 2), ElementsAre(5.0, 0.1));
  ASSERT_EQ(recording.keys.size(), 1U);
  EXPECT_TRUE(recording.keys[0].is_list);
  EXPECT_FALSE(recording.keys[0].required);
  EXPECT_EQ(recording.keys[0].default_text, "[5, 0.1]");
}

TEST(StrictYaml, ReadsListsOfMappings) {
  YamlMap yaml = parsed("cameras:\n  - name: a\n  - name: b\n    extra: 1\n");
  std::vector<std::string> names;
  for (YamlMap& camera : yaml.require_map_list("cameras")) {
    names.push_back(camera.require<std::string>("name"));
  }
  EXPECT_THAT(names, ElementsAre("a", "b"));
  EXPECT_THAT(finish_error(yaml), StartsWith("t.yaml:4: cameras[1].extra: found an unknown key"));

  YamlMap scalars = parsed("cameras: [1]\n");
  scalars.require_map_list("cameras");
  EXPECT_EQ(finish_error(scalars), "t.yaml:1: cameras[0]: found 1, wanted a mapping");
}

TEST(StrictYaml, ReadsChoices) {
  enum class Colour { kRed, kBlue };
  const std::initializer_list<std::pair<std::string_view, Colour>> colours = {
      {"red", Colour::kRed}, {"blue", Colour::kBlue}};
  YamlMap yaml = parsed("paint: blue\n");
  EXPECT_EQ(yaml.require_choice("paint", colours), Colour::kBlue);
  EXPECT_EQ(yaml.optional_choice("roof", Colour::kBlue, colours), Colour::kBlue);
  EXPECT_TRUE(yaml.finish().has_value());

  YamlMap wrong = parsed("paint: green\n");
  wrong.require_choice("paint", colours);
  EXPECT_EQ(finish_error(wrong), "t.yaml:1: paint: found green, wanted one of red, blue");
}

TEST(StrictYaml, CallersCanRejectWhatTheyRead) {
  YamlMap yaml = parsed("from: 3\nto: 1\n");
  yaml.require<int>("from");
  yaml.require<int>("to");
  yaml.reject("to", "1", "at least from, which is 3");
  EXPECT_EQ(finish_error(yaml), "t.yaml:2: to: found 1, wanted at least from, which is 3");
}

/// Without a check, yaml-cpp would parse such a text without end and fill the memory.
TEST(StrictYaml, RefusesTextThatNeverEnds) {
  for (const char* const text :
       {",", " ,\n", "# comment\n, a: 1\n", ",]", "--- ,", "a: 1\n---\n,\n"}) {
    EXPECT_THAT(parse_error(text), StartsWith("t.yaml:")) << text;
  }
}

TEST(StrictYaml, AllowsAnEmptyDocumentAtTheEnd) {
  EXPECT_EQ(parsed("a: 1\n---\n").require<int>("a"), 1);
}

TEST(StrictYaml, RefusesWhatIsNotOneMapping) {
  EXPECT_EQ(parse_error("- a\n- b\n"), "t.yaml:1: found a list of 2, wanted a mapping");
  EXPECT_THAT(parse_error(""), HasSubstr("found 0 YAML documents"));
  EXPECT_THAT(parse_error("a: 1\n---\nb: 2\n"), StartsWith("t.yaml:3: found a second document"));
  EXPECT_THAT(parse_error("a: 1\nb: [1, 2\nc: 3\n"), StartsWith("t.yaml:"));
  EXPECT_THAT(parse_error("a: *nowhere\n"), HasSubstr("found text that is not YAML"));
  EXPECT_THAT(parse_error(std::string(5000, '[')), HasSubstr("found text that is not YAML"));
}

TEST(StrictYaml, NamesAFileThatCannotBeRead) {
  const auto missing = YamlMap::read_file("/nonexistent/rig.yaml");
  ASSERT_FALSE(missing.has_value());
  EXPECT_THAT(missing.error().message, StartsWith("/nonexistent/rig.yaml: found no readable file"));
  EXPECT_FALSE(YamlMap::read_file("/").has_value());
}

}  // namespace
}  // namespace bevloc
