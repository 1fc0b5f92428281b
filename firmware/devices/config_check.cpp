#include "firmware/devices/config_check.h"

#include <spdlog/spdlog.h>

#include "can/secoc/secoc_files.h"
#include "common/output_file.h"
#include "drivers/gpio/libgpiod_gpio.h"
#include "firmware/config/config_key.h"
#include "firmware/config/localizer_options.h"
#include "firmware/devices/camera_factory.h"
#include "firmware/devices/can_bus.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/localization/localizer.h"
#include "pipeline/map/map_index.h"
#include "pipeline/map/map_loader.h"
#include "pipeline/map/map_summary.h"
#include "pipeline/preprocessing/view_check.h"

namespace bevloc::firmware {
namespace {

Status check_lines(const GpioConfig& gpio) {
  for (const drivers::LineAddress& address : lines_of(gpio)) {
    const Status found = at_key("gpio", drivers::LibgpiodGpio().look_for(address));
    if (!found) return found;
  }
  return {};
}

/// Opens and closes the appliance's socket.
Status check_can(const CanConfig& can) {
  if (can.driver == CanDriver::kMock) return {};
  const auto bus = at_key("can.interface", open_can_bus(can));
  return bus ? Status() : tl::unexpected(bus.error());
}

/// Checks that the daemon can replace this file while it runs.
Status check_written_file(const char* key, const std::filesystem::path& file) {
  if (file.empty()) return {};
  // Nobody creates a missing folder, except that systemd creates this one when it first starts
  // bevlocd (StateDirectory in systemd/bevlocd.service).
  const bool systemd_creates = folder_of(file) == "/var/lib/bevloc";
  std::error_code ignored;
  if (systemd_creates && !std::filesystem::exists(folder_of(file), ignored)) return {};
  return at_key(key, check_replaceable(file));
}

/// Makes the localizer that the daemon makes, but without a map, and runs its check of network and
/// solvers.
Status check_model(const Config& config, const Rig& rig) {
  const HdMap no_map;
  const MapIndex index(no_map);
  const std::string file = config.model_file.string();
  const auto localizer = Localizer::create(rig, index, file, localizer_options_of(config));
  if (!localizer) return tl::unexpected(localizer.error());
  const Status checked = (*localizer)->check();
  return checked ? checked : fail("{}: {}", file, checked.error().message);
}

Status check_map(const std::filesystem::path& file) {
  const auto map = load_map(file);
  if (!map) return tl::unexpected(map.error());
  for (const std::string& warning : warnings_of(*map))
    spdlog::warn("{}: {}", file.string(), warning);
  return {};
}

Status check_secoc(const SecocConfig& secoc) {
  constexpr const char* kStartsKey = "can.secoc.starts_file";
  const auto key = at_key("can.secoc.key_file", can::read_secoc_key(secoc.key_file));
  if (!key) return tl::unexpected(key.error());
  const auto starts = at_key(kStartsKey, can::read_start_number(secoc.starts_file));
  if (!starts) return tl::unexpected(starts.error());
  return check_written_file(kStartsKey, secoc.starts_file);
}

}  // namespace

Status check_shown(const Rig& rig, const std::filesystem::path& file) {
  const auto warning = at_key("calibration.rig", check_views(rig, file.string()));
  if (!warning) return tl::unexpected(warning.error());
  if (!warning->empty()) spdlog::warn("calibration.rig: {}", *warning);
  return {};
}

Status check_config(const Config& config) {
  const auto rig = at_key("calibration.rig", read_rig(config.rig_file));
  if (!rig) return tl::unexpected(rig.error());
  if (Status shown = check_shown(*rig, config.rig_file); !shown) return shown;
  const Status model = at_key("model.file", check_model(config, *rig));
  if (!model) return model;
  if (!config.map_file.empty()) {
    if (Status map = at_key("map.file", check_map(config.map_file)); !map) return map;
  }
  if (config.can.secoc) {
    if (Status secoc = check_secoc(*config.can.secoc); !secoc) return secoc;
  }
  const Status learned =
      check_written_file("calibration.online.file", config.learned_calibration_file);
  if (!learned) return learned;
  if (Status status = check_lines(config.gpio); !status) return status;
  if (Status status = check_can(config.can); !status) return status;
  return check_cameras(config.cameras, *rig);
}

}  // namespace bevloc::firmware
