// vehicle_can: sends the odometry and GNSS of a drive on a CAN interface, and the beat of the
// cameras to the host. Both follow the clock of the machine that it runs on.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <fstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "evaluation/drive/bus_factory.h"
#include "evaluation/drive/simulated_drive.h"

namespace {

using namespace bevloc;
using namespace bevloc::evaluation;

constexpr Duration kPatience = std::chrono::milliseconds(100);
constexpr Duration kLead = std::chrono::seconds(1);

std::atomic<bool> g_stop_requested{false};

/// Commands the cameras on the host to expose. Image K is due K periods after the drive's start.
class Beat {
 public:
  Beat(const std::string& channel, Time drive_start, double rate_hz)
      : channel_(channel), drive_start_(drive_start), rate_hz_(rate_hz) {}

  Time next_due() const {
    return drive_start_ + from_seconds(static_cast<double>(index_) / rate_hz_);
  }

  void send_due(Time now) {
    while (next_due() <= now) channel_ << "expose " << index_++ << std::endl;
  }

  uint64_t count() const { return index_; }

 private:
  std::ofstream channel_;
  Time drive_start_;
  double rate_hz_;
  uint64_t index_ = 0;
};

/// Prints the drive's start on the wall clock, which bus logs use, and on the monotonic clock,
/// which timestamps frames. The judge needs both to convert to the drive's time.
void announce(Time drive_start, Time now) {
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  const double wall_s = std::chrono::duration<double>(wall).count();
  fmt::print("drive_start {:.6f} {:.6f}\n", wall_s + to_seconds(drive_start - now),
             to_seconds(drive_start.time_since_epoch()));
  std::fflush(stdout);
}

Status drive(const std::string& config_file, const std::string& channel) {
  const auto config = load_drive_config(config_file);
  if (!config) return tl::unexpected(config.error());
  if (!config->simulation) {
    return fail("{}: found no section simulation, wanted a drive", config_file);
  }
  const auto drive = SimulatedDrive::create(*config);
  if (!drive) return tl::unexpected(drive.error());
  BusFactory buses(config->can);
  auto bus = buses.connect();
  if (!bus) return tl::unexpected(bus.error());

  drivers::MonotonicClock clock;
  const Time drive_start = clock.now() + kLead;
  const Time drive_end = drive_start + from_seconds(config->simulation->duration_s);
  SimulatedVehicle vehicle(*drive, config->simulation->seed, config->can, std::move(*bus),
                           drive_start);
  Beat beat(channel, drive_start, config->cameras.rate_hz);
  announce(drive_start, clock.now());
  while (!g_stop_requested && clock.now() < drive_end) {
    clock.sleep_until(std::min({vehicle.next_due(), beat.next_due(), clock.now() + kPatience}));
    beat.send_due(clock.now());
    vehicle.send_due(clock.now());
  }
  fmt::print("exposures {}\n", beat.count());
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Sends a drive's odometry and GNSS on CAN, and its cameras' beat to a channel");
  std::string config_file;
  std::string channel = "/dev/null";
  app.add_option("--config", config_file, "Configuration with a section `simulation`")->required();
  app.add_option("--beat", channel, "Channel for `expose K`, the commands to the cameras");
  CLI11_PARSE(app, argc, argv);
  const auto stop = [](int) { g_stop_requested = true; };
  std::signal(SIGTERM, stop);
  std::signal(SIGINT, stop);

  const Status status = drive(config_file, channel);
  if (status) return 0;
  fmt::print(stderr, "vehicle_can: {}\n", status.error().message);
  return 2;
}
