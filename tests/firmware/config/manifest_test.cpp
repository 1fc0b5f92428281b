// The manifest of checksums: its format, and what stops the start.
#include "firmware/config/manifest.h"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/files.h"
#include "common/sha256.h"
#include "firmware/config/config.h"
#include "tests/support/temporary_folder.h"

namespace bevloc::firmware {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

TEST(Sha256, KnownChecksums) {
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

std::string error_in(std::string_view text) {
  const auto entries = parse_manifest(text, "m");
  return entries ? "" : entries.error().message;
}

TEST(Manifest, ReadsTheFormatOfSha256sum) {
  const std::string digits(64, 'a');
  const auto entries =
      parse_manifest("# files\n" + digits + "  a.bvm\r\n\n" + digits + " *b c.yaml", "m");
  ASSERT_TRUE(entries.has_value()) << entries.error().message;
  ASSERT_EQ(entries->size(), 2U);
  EXPECT_EQ((*entries)[0].file, "a.bvm");
  EXPECT_EQ((*entries)[0].line, 2);
  EXPECT_EQ((*entries)[1].file, "b c.yaml");
  EXPECT_EQ((*entries)[1].sha256, digits);
}

TEST(Manifest, RefusesOtherLines) {
  const std::string digits(64, 'a');
  EXPECT_THAT(error_in(""), HasSubstr("m: found no checksum"));
  EXPECT_THAT(error_in("\n# nothing\n"), HasSubstr("m: found no checksum"));
  for (const std::string& line :
       {digits, digits + "  ", digits + " a", digits.substr(1) + "  a",
        std::string(64, 'A') + "  a", std::string(64, 'g') + "  a", "\\" + digits + "  a"}) {
    EXPECT_THAT(error_in("#\n" + line), StartsWith("m:2: found \"")) << line;
  }
}

TEST(Manifest, ShowsOnlyTheBeginningOfALongLine) {
  const std::string beginning(80, 'x');
  const std::string error = error_in(beginning + std::string(100'000, 'y'));
  EXPECT_THAT(error, HasSubstr("found \"" + beginning + "\", wanted"));
}

class ManifestFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "maps");
    store("config.yaml", "cameras");
    store("maps/town.bvm", "town");
    store("bevloc.manifest", line("config.yaml") + line("maps/town.bvm"));
  }

  void store(const char* name, std::string_view bytes) const {
    ASSERT_TRUE(write_file(folder_ / name, bytes).has_value());
  }
  std::string line(const char* name) const {
    return sha256_hex(read_file(folder_ / name).value()) + "  " + name + "\n";
  }
  std::string check() const {
    const std::array<fs::path, 3> used = {folder_ / "config.yaml", folder_ / "maps/town.bvm", ""};
    const Status status = check_manifest(folder_ / "bevloc.manifest", used);
    return status ? "" : status.error().message;
  }

  const test::TemporaryFolder folder_;
};

TEST_F(ManifestFiles, AcceptsTheRightFiles) {
  EXPECT_EQ(check(), "");
}

TEST_F(ManifestFiles, RefusesAChangedFileByName) {
  store("maps/town.bvm", "tawn");
  EXPECT_THAT(check(), HasSubstr("bevloc.manifest:2: "));
  EXPECT_THAT(check(), HasSubstr("maps/town.bvm: found SHA-256 " + sha256_hex("tawn") +
                                 ", wanted " + sha256_hex("town")));
}

TEST_F(ManifestFiles, RefusesAMissingFile) {
  fs::remove(folder_ / "maps/town.bvm");
  EXPECT_THAT(check(), HasSubstr("town.bvm: found no readable file"));
}

TEST_F(ManifestFiles, RefusesAFileThatItDoesNotList) {
  store("bevloc.manifest", line("config.yaml"));
  EXPECT_THAT(check(), HasSubstr("found no checksum of " + (folder_ / "maps/town.bvm").string()));
}

TEST_F(ManifestFiles, RefusesAMissingManifest) {
  fs::remove(folder_ / "bevloc.manifest");
  EXPECT_THAT(check(), HasSubstr("bevloc.manifest: found no readable file"));
}

/// A new manifest says nothing about the files that were read before it was written.
TEST_F(ManifestFiles, RefusesAManifestThatHasChangedSinceItWasRead) {
  Config config;
  EXPECT_TRUE(check_manifest_of(config)) << "there is none";
  config.file = folder_ / "config.yaml";
  config.map_file = folder_ / "maps/town.bvm";
  config.manifest_file = folder_ / "bevloc.manifest";
  config.kept_files.keep(config.manifest_file);
  EXPECT_TRUE(check_manifest_of(config));
  store("maps/town.bvm", "city");
  store("bevloc.manifest", line("config.yaml") + line("maps/town.bvm"));
  const Status changed = check_manifest_of(config);
  ASSERT_FALSE(changed);
  EXPECT_THAT(changed.error().message,
              HasSubstr("bevloc.manifest: found a manifest that has changed since"));
}

/// The configuration names its manifest, and nothing is loaded from files that do not match.
TEST_F(ManifestFiles, LoadConfigChecksTheManifest) {
  const fs::path source = BEVLOC_SOURCE_DIR;
  std::string text = read_file(source / "tests/hil/config/usb.yaml").value();
  store("usb.yaml", text + "\nmanifest: bevloc.manifest\n");
  const auto listed = load_config(folder_ / "usb.yaml");
  ASSERT_FALSE(listed.has_value());
  EXPECT_THAT(listed.error().message, HasSubstr("found no checksum of"));
  store("usb.yaml", text + "\nmanifest: none\n");
  EXPECT_THAT(load_config(folder_ / "usb.yaml").error().message,
              HasSubstr("none: found no readable file"));
}

/// A wrong DBC file would scale the vehicle's signals wrongly.
TEST_F(ManifestFiles, MustListTheDbcFileOfTheVehicle) {
  const fs::path source = BEVLOC_SOURCE_DIR;
  std::string text = read_file(source / "config/demo_own_bus.yaml").value();
  text.resize(text.find("simulation:"));
  for (const auto& [from, to] :
       {std::pair("driver: mock\n  rate_hz: 10", "driver: replay\n  recording: .."),
        {"procedural_seed: 7", "file: maps/town.bvm"},
        {"../models/nano.onnx", "config.yaml"},
        {"rig_demo.yaml", "config.yaml"}}) {
    text.replace(text.find(from), std::string_view(from).size(), to);
  }
  store("bus.yaml", text + "manifest: bevloc.manifest\n");
  store("vehicle_demo.dbc", read_file(source / "config/vehicle_demo.dbc").value());
  const std::string others = line("config.yaml") + line("maps/town.bvm") + line("bus.yaml");
  store("bevloc.manifest", others);
  const auto without = load_config(folder_ / "bus.yaml");
  ASSERT_FALSE(without.has_value());
  EXPECT_THAT(without.error().message, HasSubstr("vehicle_demo.dbc, wanted those of configuration, "
                                                 "rig, model, map and the vehicle's DBC file"));
  store("bevloc.manifest", others + line("vehicle_demo.dbc"));
  const auto with = load_config(folder_ / "bus.yaml");
  EXPECT_TRUE(with.has_value()) << with.error().message;
}

}  // namespace
}  // namespace bevloc::firmware
