// The fixture of the tests that load configuration files.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "evaluation/drive/drive_config.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/text.h"

namespace bevloc::firmware {

inline const std::filesystem::path kSource = BEVLOC_SOURCE_DIR;

using test::read_text;

/// Gives each test an empty folder for a configuration and the files that it names.
class ConfigTest : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  void put_model(const std::string& name) const {
    std::filesystem::copy_file(kSource / "models/nano.onnx", folder_ / name,
                               std::filesystem::copy_options::overwrite_existing);
  }
  void put_map(const std::string& name) const {
    std::filesystem::copy_file(kSource / "tests/pipeline/map/fixtures/street.osm", folder_ / name,
                               std::filesystem::copy_options::overwrite_existing);
  }

  Result<evaluation::DriveConfig> load(const std::string& yaml) const {
    write("test.yaml", yaml);
    return evaluation::load_drive_config(folder_ / "test.yaml");
  }

  /// The error message of loading; empty without an error.
  std::string error_of(const std::string& yaml) const {
    const auto config = load(yaml);
    return config ? "" : config.error().message;
  }

  /// The beginning of an error message for this line.
  std::string place(int line) const {
    return (folder_ / "test.yaml").string() + ":" + std::to_string(line) + ": ";
  }

  const test::TemporaryFolder folder_;
};

/// The smallest valid configuration of a simulated drive. Line 1 is `cameras:`.
inline const std::string kSmallest =
    "cameras:\n"
    "  driver: mock\n"
    "  rate_hz: 10\n"
    "calibration: {rig: rig.yaml}\n"
    "map: {procedural_seed: 7}\n"
    "model: {file: sub/model.onnx}\n"
    "can: {driver: mock}\n"
    "simulation: {seed: 1, duration_s: 5}\n";

/// Returns kSmallest with `from`, which occurs once, replaced by `to`.
inline std::string with(const std::string& from, const std::string& to) {
  std::string text = kSmallest;
  const size_t position = text.find(from);
  EXPECT_NE(position, std::string::npos) << from;
  return text.replace(position, from.size(), to);
}

}  // namespace bevloc::firmware
