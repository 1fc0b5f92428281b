// bevlocd with the simulator. With mock cameras it drives through a simulated world and a judge
// compares its poses with the truth; otherwise it runs like firmware/bevlocd.cpp.
#include <spdlog/spdlog.h>

#include "common/files.h"
#include "common/option_checks.h"
#include "common/output_file.h"
#include "drivers/gpio/libgpiod_gpio.h"
#include "evaluation/drive/bus_factory.h"
#include "evaluation/drive/simulated_run.h"
#include "evaluation/town_seeds.h"
#include "firmware/config/config_key.h"
#include "firmware/config/files_of_config.h"
#include "firmware/daemon/daemon.h"
#include "firmware/daemon/program.h"
#include "pipeline/calibration/rig_yaml.h"
#include "sim/render/photo_library.h"

namespace {

using namespace bevloc;
using namespace bevloc::evaluation;

/// Command line options of a simulated drive. Each one overrides the configuration.
struct DriveOptions {
  std::optional<uint64_t> seed;
  std::optional<double> duration_s;
  std::string map_file;
  std::string out;
  std::string pictures_folder;
  std::string json_file;
  bool fast = false;

  bool any() const {
    return seed || duration_s || !map_file.empty() || !out.empty() || !json_file.empty() ||
           !pictures_folder.empty() || fast;
  }
};

void declare_options(CLI::App& app, DriveOptions& options) {
  auto* drive = app.add_option_group("Simulated drive (mock cameras)");
  drive->add_option("--seed", options.seed, "Seed of the town, the drive and all noise")
      ->check(whole_number());
  drive->add_option("--duration", options.duration_s, "Length of the drive, seconds")
      ->check(number_between(kShortestDrive_s, kLongestDrive_s));
  drive
      ->add_option("--map", options.map_file,
                   "Drive through this HD map of any format (docs/maps.md)")
      ->check(is_name_of("a map"));
  drive
      ->add_option("--out", options.out,
                   "Folder for can.log, poses.csv and sheet.png (default: out)")
      ->check(is_name_of("a folder"));
  drive
      ->add_option("--save-pictures", options.pictures_folder,
                   "Write pictures and reference poses to this folder, for `bevloc calib`")
      ->check(is_name_of("a folder"));
  drive->add_option("--json", options.json_file, "Write the result as JSON to this file")
      ->check(output_name());
  drive->add_flag("--fast", options.fast,
                  "Virtual clock: runs as fast as the machine can, with repeatable results");
}

Status apply(const DriveOptions& options, const std::string& config_file, DriveConfig& config) {
  if (!config.simulation) {
    if (!options.any()) return {};
    return fail(
        "{}: found cameras that are not mock, wanted mock ones for --seed, --duration, "
        "--map, --out, --json, --save-pictures and --fast",
        config_file);
  }
  if (options.seed) {
    config.simulation->seed = *options.seed;
    if (config.simulation->town_seed) config.simulation->town_seed = *options.seed;
  }
  if (options.duration_s) config.simulation->duration_s = *options.duration_s;
  if (!options.map_file.empty()) {
    config.simulation->town_seed.reset();
    config.map_file = options.map_file;
  }
  return check_town_seeds("--seed", config.simulation->town_seed.value_or(0));
}

Status simulate(const DriveOptions& options, const DriveConfig& config, const Rig& rig) {
  SimulatedRunOptions run;
  run.fast = options.fast;
  run.out = options.out.empty() ? "out" : options.out;
  run.pictures_folder = options.pictures_folder;
  if (Status made = create_folder(run.out); !made) return made;
  if (Status writable = check_writable(options.json_file); !writable) return writable;
  const auto report = run_simulation(
      config, rig, run, [](const firmware::ApplianceView&) { return firmware::stop_requested(); });
  if (!report) return tl::unexpected(report.error());
  fmt::print("{}", to_table(*report));
  return write_option_file(options.json_file, to_json(*report));
}

/// Reads the photographs of the street, which only the simulator knows.
Status check_photos(const DriveConfig& config) {
  if (!config.simulation || config.simulation->street.photos.empty()) return {};
  const auto photos = firmware::at_key("simulation.street.photos",
                                       sim::PhotoLibrary::load(config.simulation->street.photos));
  return photos ? Status() : tl::unexpected(photos.error());
}

Status run(const firmware::ProgramOptions& program, const DriveOptions& drive,
           const firmware::LogWriter& log) {
  auto config = load_drive_config(program.config_file);
  if (!config) return tl::unexpected(config.error());
  if (Status status = apply(drive, program.config_file, *config); !status) return status;
  if (Status status = firmware::override_config(program, *config); !status) return status;
  if (Status other = check_output(drive.json_file, files_of(*config)); !other) return other;
  if (program.check_config) {
    const Status photos = check_photos(*config);
    return photos ? firmware::check_and_print(program, *config) : photos;
  }
  firmware::set_log_level(config->log_level);
  const auto rig = firmware::rig_of(*config);
  if (!rig) return tl::unexpected(rig.error());
  if (config->simulation) return simulate(drive, *config, *rig);
  BusFactory buses(config->can);
  const auto open_bus = [&buses] { return buses.connect_appliance(); };
  drivers::LibgpiodGpio gpio;
  return firmware::run_daemon(*config, *rig, {gpio, open_bus, firmware::stop_requested, &log});
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Localizes a vehicle in its HD map");
  firmware::ProgramOptions program;
  DriveOptions drive;
  firmware::declare_options(app, program);
  declare_options(app, drive);
  return firmware::run_program(
      app, argc, argv, [&](const firmware::LogWriter& log) { return run(program, drive, log); });
}
