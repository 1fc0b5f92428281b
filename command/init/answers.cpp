#include "command/init/answers.h"

#include <fmt/format.h>

namespace bevloc::command {
namespace {

/// Returns the text in double quotes, for YAML.
std::string quoted_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

std::string path_text(const std::filesystem::path& file, const std::filesystem::path& folder) {
  const auto whole = std::filesystem::absolute(file).lexically_normal();
  const auto relative =
      whole.lexically_relative(std::filesystem::absolute(folder).lexically_normal());
  const bool below = !relative.empty() && *relative.begin() != "..";
  return quoted_text((below ? relative : whole).string());
}

std::string cameras_text(const Answers& answers) {
  if (answers.driver == kMockCameras) {
    return "# Simulated cameras in a simulated world.\n"
           "cameras:\n"
           "  driver: mock\n"
           "  rate_hz: 10\n";
  }
  std::string text = fmt::format(
      "# The ids stay the same after a restart. An id with a serial number stays with its camera "
      "when plugs\n"
      "# change; an id with a path or a port belongs to the plug.\n"
      "# Cameras without a trigger expose at different times: set tolerance_ms to a little less "
      "than one frame\n"
      "# period, at most 50.\n"
      "cameras:\n"
      "  driver: {}\n"
      "  ids:\n",
      answers.driver);
  for (int camera = 0; camera < kCameraCount; ++camera) {
    text += fmt::format("    {}: {}\n", kCameraNames[camera], quoted_text(answers.ids[camera]));
  }
  return text;
}

std::string map_text(const std::filesystem::path& map, const std::filesystem::path& folder) {
  if (map.empty()) {
    return "\n# A simulated town. Another number is another town.\n"
           "map:\n  procedural_seed: 7\n";
  }
  return fmt::format(
      "\n# The HD map, in any format of docs/maps.md.\n"
      "map:\n  file: {}\n",
      path_text(map, folder));
}

std::string can_text(const std::string& interface) {
  if (interface == kMockCameras) {
    return "# A bus inside the process; its frames are written to can.log.\n"
           "can:\n"
           "  driver: mock\n";
  }
  return fmt::format(
      "# The vehicle's messages come from this interface, and the poses go to it (docs/can.md).\n"
      "can:\n"
      "  driver: socketcan\n"
      "  interface: {}\n",
      quoted_text(interface));
}

}  // namespace

std::string configuration_text(const Answers& answers, const std::filesystem::path& folder) {
  std::string text =
      "# yaml-language-server: $schema=bevlocd.schema.json\n"
      "# Written by `bevloc init`. docs/configuration.md describes every key; what is not given "
      "here\n"
      "# keeps its default. `bevloc schema > bevlocd.schema.json` lets an editor complete the "
      "keys.\n";
  text += cameras_text(answers);
  text += fmt::format(
      "\n# The calibration of the six cameras (docs/bring-your-own.md).\n"
      "calibration:\n  rig: {}\n",
      path_text(answers.rig, folder));
  text += map_text(answers.map, folder);
  text += fmt::format("\nmodel:\n  file: {}\n\n", path_text(answers.model, folder));
  text += can_text(answers.can);
  if (answers.driver == kMockCameras) {
    text +=
        "\n# The drive that the simulated cameras see.\n"
        "simulation:\n  seed: 1\n  duration_s: 60\n";
  }
  return text;
}

}  // namespace bevloc::command
