// bevlocd for vehicles: localizes the vehicle in its HD map. It contains no simulator; the program
// with the simulator is evaluation/drive/bevlocd.cpp.
#include "drivers/gpio/libgpiod_gpio.h"
#include "firmware/daemon/daemon.h"
#include "firmware/daemon/program.h"
#include "firmware/devices/can_bus.h"

namespace {

using namespace bevloc;
using namespace bevloc::firmware;

Status run(const ProgramOptions& options, const LogWriter& log) {
  auto config = load_config(options.config_file);
  if (!config) return tl::unexpected(config.error());
  if (Status status = override_config(options, *config); !status) return status;
  if (options.check_config) return check_and_print(options, *config);
  set_log_level(config->log_level);
  const auto rig = rig_of(*config);
  if (!rig) return tl::unexpected(rig.error());
  drivers::LibgpiodGpio gpio;
  const auto open_bus = [&config] { return open_can_bus(config->can); };
  return run_daemon(*config, *rig, {gpio, open_bus, stop_requested, &log});
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Localizes a vehicle in its HD map");
  ProgramOptions options;
  declare_options(app, options);
  return run_program(app, argc, argv,
                     [&options](const LogWriter& log) { return run(options, log); });
}
