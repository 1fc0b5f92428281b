#include "command/doctor/config_checks.h"

#include <algorithm>
#include <array>

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "command/doctor/machine_checks.h"
#include "command/shell_word.h"
#include "common/files.h"
#include "common/sha256.h"
#include "drivers/camera/replay/replay_camera.h"
#include "drivers/camera/v4l2/device_finder.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/preprocessing/view_check.h"

namespace bevloc::command {
namespace {

using firmware::CameraDriver;
using firmware::CanDriver;
using firmware::Config;

Finding check_file(const std::string& part, const std::filesystem::path& file) {
  const Result<std::string> bytes = read_file(file);
  if (!bytes) {
    return {Level::kProblem, part, bytes.error().message, "a readable file",
            "ls -l " + shell_word(file.string())};
  }
  return ok(part, fmt::format("{}, SHA-256 {}", file.string(), sha256_hex(*bytes)));
}

Finding check_rig_file(const Config& config) {
  Finding finding = check_file("rig", config.rig_file);
  if (finding.level != Level::kOk) return finding;
  const std::string file = config.rig_file.string();
  const auto warning =
      read_rig(config.rig_file).and_then([&](const Rig& rig) { return check_views(rig, file); });
  if (!warning) {
    return {Level::kProblem, "rig", warning.error().message, "a rig that bevlocd accepts",
            fmt::format("bevlocd --config {} --check-config", shell_word(config.file.string()))};
  }
  if (warning->empty()) return finding;
  return {Level::kWarning, "rig", *warning, "cameras that show the road down to the vehicle",
          fmt::format("bevloc eval rig {}   # on a machine with the simulator: what this costs",
                      shell_word(file))};
}

/// How a user gets access to a device.
struct Access {
  std::string group;
  std::string fix;
};

Access camera_access() {
  return {"video", "sudo usermod -aG video $USER   # then log in again"};
}

Access gpio_access(const Config& config) {
  return {"bevloc",
          fmt::format("sudo bevloc udev-rules --config {} --out "
                      "/etc/udev/rules.d/60-bevloc.rules && sudo udevadm control --reload && sudo "
                      "udevadm trigger --settle --subsystem-match=gpio   # then run the doctor as "
                      "the user bevloc, or: sudo usermod -aG bevloc $USER, and log in again",
                      shell_word(config.file.string()))};
}

/// Checks whether this user may open a device.
Finding check_access(const Machine& machine, const std::string& part,
                     const std::filesystem::path& node, const std::string& found,
                     const Access& access) {
  if (machine.may_use(node)) return ok(part, found);
  return {Level::kProblem, part, fmt::format("found {}, which this user may not open", found),
          fmt::format("read and write access, by the group {}", access.group), access.fix};
}

Findings check_v4l2_cameras(const Machine& machine, const Config& config) {
  const drivers::v4l2::DeviceTree tree{machine.real("/sys"), machine.real("/dev")};
  Findings findings;
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const std::string part = fmt::format("camera {}", kCameraNames[camera]);
    const std::string& id = config.cameras.devices.ids[camera];
    const auto node = drivers::v4l2::find_video_node(id, tree);
    findings.push_back(node ? check_access(machine, part, *node,
                                           fmt::format("{} ({})", id, node->filename().string()),
                                           camera_access())
                            : Finding{Level::kProblem, part, node.error().message,
                                      "the camera that cameras.ids names", "ls -l /dev/v4l/by-id"});
  }
  return findings;
}

Findings check_libcamera_cameras(const Machine& machine, const Config& config) {
  Findings findings;
  const auto known = machine.libcamera_ids();
  for (int camera = 0; camera < kCameraCount; ++camera) {
    const std::string part = fmt::format("camera {}", kCameraNames[camera]);
    const std::string& id = config.cameras.devices.ids[camera];
    if (known && std::ranges::find(*known, id) != known->end()) {
      findings.push_back(ok(part, id));
      continue;
    }
    findings.push_back(
        {Level::kProblem, part,
         known ? fmt::format("found no camera \"{}\", only: {}", id, fmt::join(*known, ", "))
               : known.error().message,
         "the camera that cameras.ids names", "cam -l"});
  }
  return findings;
}

Findings check_recordings(const Config& config) {
  Findings findings;
  for (const std::string_view camera : kCameraNames) {
    const std::string part = fmt::format("camera {}", camera);
    const std::filesystem::path folder = config.cameras.recording / camera;
    const auto frames = drivers::load_recording(folder);
    findings.push_back(frames
                           ? ok(part, fmt::format("{}, {} frames", folder.string(), frames->size()))
                           : Finding{Level::kProblem, part, frames.error().message,
                                     "a picture folder in cameras.recording (docs/drivers.md)",
                                     "ls " + shell_word(folder.string())});
  }
  return findings;
}

/// Checks whether this user may open any chip. A vehicle needs only some of them, which
/// systemd/udev/60-bevloc.rules opens.
Finding check_gpio_access(const Machine& machine, const Config& config) {
  Findings findings;
  for (const std::string& name : machine.names_in("/dev")) {
    if (!name.starts_with("gpiochip")) continue;
    const std::string node = "/dev/" + name;
    findings.push_back(
        check_access(machine, "gpio", machine.real(node), node, gpio_access(config)));
  }
  const auto usable = std::ranges::find(findings, Level::kOk, &Finding::level);
  if (usable != findings.end()) return *usable;
  if (!findings.empty()) return findings.front();
  return {Level::kProblem, "gpio", "found no /dev/gpiochip*",
          "the chip that the section gpio names", "gpiodetect"};
}

Findings check_gpio_lines(const Machine& machine, const Config& config) {
  if (const Finding access = check_gpio_access(machine, config); access.level != Level::kOk) {
    return {access};
  }
  Findings findings;
  const std::vector<drivers::GpioChipInfo> chips = machine.gpio_chips();
  for (const drivers::LineAddress& line : lines_of(config.gpio)) {
    const auto place = drivers::find_line(chips, line);
    findings.push_back(
        place ? ok("gpio", fmt::format("{} (/dev/{})", to_string(line), chips[place->chip].name))
              : Finding{Level::kProblem, "gpio", place.error().message,
                        "the line that the section gpio names", "gpioinfo"});
  }
  return findings;
}

/// The kind of an interface with a controller, as `ip` calls it.
constexpr const char* kController = "can";

/// The part of `ip -details -json link show` that the doctor reads.
struct CanLink {
  bool up = false;
  std::string kind;   ///< "can" for a controller, "vcan", "vxcan"; some old drivers show none
  std::string state;  ///< ERROR-ACTIVE, ERROR-PASSIVE, BUS-OFF, STOPPED
  int64_t bit_rate = 0;
  int64_t restart_ms = 0;
  int64_t tx_errors = 0;
  int64_t rx_errors = 0;
};

std::optional<CanLink> parse_link(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_array() || json.empty() || !json[0].is_object()) return std::nullopt;
  const auto& link = json[0];
  CanLink can;
  if (link.contains("flags") && link["flags"].is_array()) {
    can.up = std::ranges::find(link["flags"], "UP") != link["flags"].end();
  }
  const auto info = link.value("linkinfo", nlohmann::json::object());
  can.kind = info.value("info_kind", "");
  const auto data = info.value("info_data", nlohmann::json::object());
  can.state = data.value("state", "");
  can.restart_ms = data.value("restart_ms", 0);
  can.bit_rate = data.value("bittiming", nlohmann::json::object()).value("bitrate", 0);
  const auto errors = data.value("berr_counter", nlohmann::json::object());
  can.tx_errors = errors.value("tx", 0);
  can.rx_errors = errors.value("rx", 0);
  return can;
}

/// Returns the command that starts an interface. The kernel keeps the bit rate of an interface that
/// is down. If there is none, the user must give it, because a wrong bit rate disturbs the bus.
std::string start_command(const std::string& name, const CanLink& link) {
  const bool is_ready = link.kind != kController || link.bit_rate > 0;
  return fmt::format("sudo ip link set {} up{}", name,
                     is_ready ? ""
                              : " type can bitrate BITRATE restart-ms 100   # BITRATE is that of "
                                "the vehicle's bus");
}

Findings judge_link(const std::string& name, const CanLink& link) {
  if (!link.up) {
    return {{Level::kProblem, name, "found an interface that is down", "an interface that is up",
             start_command(name, link)}};
  }
  if (link.kind == "vcan" || link.kind == "vxcan") {
    return {ok(name, "up, virtual: no other machine hears it")};
  }
  if (link.kind != kController) {
    return {ok(name, "up; its driver shows neither bit rate nor errors")};
  }
  Findings findings;
  const std::string counters =
      fmt::format("{} bit/s, {}, error counters tx {} rx {}", link.bit_rate, link.state,
                  link.tx_errors, link.rx_errors);
  if (link.state == "BUS-OFF" || link.state == "STOPPED") {
    // `type can restart` is refused where restart-ms is set.
    findings.push_back({Level::kProblem, name, "found " + counters, "ERROR-ACTIVE",
                        fmt::format("sudo ip link set {0} down && sudo ip link set {0} up", name)});
  } else if (link.state != "ERROR-ACTIVE" || link.tx_errors > 0 || link.rx_errors > 0) {
    findings.push_back({Level::kWarning, name, "found " + counters,
                        "ERROR-ACTIVE without errors: check bit rate, wiring and termination",
                        fmt::format("ip -details -statistics link show {}", name)});
  } else {
    findings.push_back(ok(name, counters));
  }
  if (link.restart_ms == 0) {
    findings.push_back(
        {Level::kWarning, name, "found restart-ms 0: the controller stays off after bus-off",
         "restart-ms 100",
         fmt::format("sudo ip link set {0} down && sudo ip link set {0} type can restart-ms 100 && "
                     "sudo ip link set {0} up",
                     name)});
  }
  return findings;
}

}  // namespace

Findings check_files(const Config& config) {
  Findings findings{check_rig_file(config), check_file("model", config.model_file)};
  if (!config.map_file.empty()) findings.push_back(check_file("map", config.map_file));
  if (config.can.secoc) findings.push_back(check_file("key", config.can.secoc->key_file));
  return findings;
}

Findings check_devices(const Machine& machine, const Config& config) {
  Findings findings;
  const auto add = [&findings](const Findings& more) {
    findings.insert(findings.end(), more.begin(), more.end());
  };
  switch (config.cameras.driver) {
    case CameraDriver::kV4l2:
      // A missing module is only a warning, because cameras other than USB cameras have drivers of
      // their own.
      add({check_module(machine, "uvcvideo", Level::kWarning)});
      add(check_v4l2_cameras(machine, config));
      break;
    case CameraDriver::kLibcamera:
      add(check_libcamera_cameras(machine, config));
      break;
    case CameraDriver::kReplay:
      add(check_recordings(config));
      break;
    case CameraDriver::kMock:
      break;
  }
  if (!lines_of(config.gpio).empty()) add(check_gpio_lines(machine, config));
  return findings;
}

Findings check_realtime(const Machine& machine, const Config& config) {
  const firmware::RealtimeConfig& realtime = config.realtime;
  int priority = 0;
  for (const auto* thread : {&realtime.capture, &realtime.vision, &realtime.can}) {
    priority = std::max(priority, thread->fifo_priority.value_or(0));
  }
  const ProcessLimits limits = machine.limits();
  Findings findings;
  if (limits.realtime_priority < priority) {
    findings.push_back({Level::kWarning, "priority",
                        fmt::format("found a limit of {}", limits.realtime_priority),
                        fmt::format("{} (LimitRTPRIO= in the unit)", priority),
                        fmt::format("sudo prlimit --pid $$ --rtprio={}", priority)});
  } else {
    findings.push_back(ok("priority", priority == 0 ? "none is configured"
                                                    : fmt::format("{} is permitted", priority)));
  }
  if (realtime.lock_memory && limits.locked_memory_bytes) {
    findings.push_back({Level::kWarning, "locked memory",
                        fmt::format("found a limit of {} bytes", *limits.locked_memory_bytes),
                        "no limit (LimitMEMLOCK=infinity in the unit)",
                        "sudo prlimit --pid $$ --memlock=unlimited"});
  } else {
    findings.push_back(ok("locked memory", realtime.lock_memory ? "unlimited" : "not configured"));
  }
  return findings;
}

Findings check_can_interface(const Machine& machine, const Config& config) {
  if (config.can.driver == CanDriver::kMock) return {ok("can", "mock: a bus inside the process")};
  Findings findings{check_module_on_demand(machine, "can"),
                    check_module_on_demand(machine, "can_raw")};
  constexpr const char* kListInterfaces = "ip -details link show type can";
  const std::string& name = config.can.interface;
  if (name.starts_with("vcan")) {
    findings.push_back(check_module(machine, "vcan", Level::kProblem));
  }
  if (!machine.exists("/sys/class/net/" + name)) {
    const bool is_virtual = name.starts_with("vcan");
    findings.push_back({Level::kProblem, name, "found no such interface",
                        "the interface of can.interface",
                        is_virtual ? fmt::format("sudo ip link add {0} type vcan && sudo ip link "
                                                 "set {0} up",
                                                 name)
                                   : std::string(kListInterfaces)});
    return findings;
  }
  if (!machine.is_can_interface(name)) {
    findings.push_back({Level::kProblem, name, "found an interface that is no CAN interface",
                        "the name of a CAN interface in can.interface", kListInterfaces});
    return findings;
  }
  const auto text = machine.run({"ip", "-details", "-json", "link", "show", name});
  const auto link = text ? parse_link(*text) : std::nullopt;
  if (!link) {
    findings.push_back({Level::kWarning, name, "found no answer of the command ip",
                        "its state, bit rate and errors", "sudo apt-get install iproute2"});
    return findings;
  }
  const Findings state = judge_link(name, *link);
  findings.insert(findings.end(), state.begin(), state.end());
  return findings;
}

}  // namespace bevloc::command
