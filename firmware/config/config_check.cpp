// Looks up on this machine what a configuration names.
#include <spdlog/spdlog.h>

#include "can/secoc/secoc_files.h"
#include "common/writable_folder.h"
#include "drivers/gpio/libgpiod_gpio.h"
#include "firmware/config/config.h"
#include "firmware/runtime/camera_factory.h"
#include "firmware/runtime/can_bus.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_loader.h"
#include "pipeline/map/map_summary.h"
#include "pipeline/network/network.h"

namespace bevloc::firmware {
namespace {

Status check_lines(const GpioConfig& gpio) {
  for (const drivers::LineAddress& address : lines_of(gpio)) {
    if (Status status = drivers::LibgpiodGpio().look_for(address); !status) {
      return fail("gpio: {}", status.error().message);
    }
  }
  return {};
}

/// Opens and closes the appliance's socket.
Status check_can(const CanConfig& can) {
  if (can.driver == CanDriver::kMock) return {};
  if (const auto bus = open_can_bus(can); !bus)
    return fail("can.interface: {}", bus.error().message);
  return {};
}

/// The daemon writes this file while it runs.
Status check_written_file(const char* key, const std::filesystem::path& file) {
  if (file.empty()) return {};
  const std::error_code error = cannot_write_in(file.parent_path());
  if (!error) return {};
  return fail(
      "{}: {}: cannot be written ({}), wanted a folder that bevlocd may write in, such as "
      "/var/lib/bevloc",
      key, file.string(), error.message());
}

}  // namespace

Status check_config(const Config& config) {
  const auto rig = read_rig(config.rig_file);
  if (!rig) return tl::unexpected(rig.error());
  const auto model = Network::load(config.model_file, {});
  if (!model) return tl::unexpected(model.error());
  if (const Status fits = check_rig_fits((*model)->rig(), *rig); !fits) {
    return fail("{}: {}", config.model_file.string(), fits.error().message);
  }
  if (!config.map_file.empty()) {
    const auto map = load_map(config.map_file);
    if (!map) return tl::unexpected(map.error());
    for (const std::string& warning : warnings_of(*map)) {
      spdlog::warn("{}: {}", config.map_file.string(), warning);
    }
  }
  if (config.can.secoc) {
    const auto key = can::read_secoc_key(config.can.secoc->key_file);
    if (!key) return tl::unexpected(key.error());
    const Status starts =
        check_written_file("can.secoc.starts_file", config.can.secoc->starts_file);
    if (!starts) return starts;
  }
  const Status learned =
      check_written_file("calibration.online.file", config.learned_calibration_file);
  if (!learned) return learned;
  if (Status status = check_lines(config.gpio); !status) return status;
  if (Status status = check_can(config.can); !status) return status;
  return check_cameras(config.cameras, *rig);
}

}  // namespace bevloc::firmware
