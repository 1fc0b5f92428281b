// A configuration of its own for a test.
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "common/files.h"
#include "tests/support/text.h"

namespace bevloc::test {

/// What a copy of the demo's configuration has of its own. Each text of a section is added at its
/// end.
struct OwnKeys {
  std::string map = "procedural_seed: 7";  ///< the section `map`
  std::string calibration;
  std::string simulation;  ///< the last section of the file
};

/// Writes a copy of the demo's configuration, own.yaml, and of its rig, rig.yaml, into this folder.
/// Returns the name of the configuration.
inline std::string write_own_config(const std::filesystem::path& folder, const OwnKeys& keys = {}) {
  const std::filesystem::path config = std::filesystem::path(BEVLOC_SOURCE_DIR) / "config";
  std::string text = read_text(config / "demo.yaml");
  const auto replace = [&text](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("procedural_seed: 7", keys.map);
  replace("rig: rig_demo.yaml\n", "rig: rig.yaml\n" + keys.calibration);
  replace("file: ../models", "file: " + config.string() + "/../models");
  EXPECT_TRUE(write_file(folder / "own.yaml", text + keys.simulation));
  EXPECT_TRUE(write_file(folder / "rig.yaml", read_text(config / "rig_demo.yaml")));
  return (folder / "own.yaml").string();
}

}  // namespace bevloc::test
