#include "firmware/config/gnss_config.h"

#include <algorithm>
#include <cctype>

#include "firmware/config/config_milliseconds.h"
#include "firmware/config/live_config.h"

namespace bevloc::firmware {
namespace {

/// Whether the name of a device is allowed. It goes into a JSON text, so it must not end a string.
bool is_device(const std::string& name) {
  return !name.empty() && name.size() <= 100 && std::ranges::all_of(name, [](unsigned char c) {
    return std::isprint(c) != 0 && c != '"' && c != '\\' && c != ' ';
  });
}

drivers::GpsdAddress read_gpsd_address(YamlMap& yaml) {
  drivers::GpsdAddress gpsd;
  gpsd.address = yaml.optional<std::string>(
      "address", gpsd.address,
      {"an IP address in numbers, such as 127.0.0.1 or ::1", is_ip_address});
  gpsd.port = static_cast<uint16_t>(
      yaml.optional<int>("port", static_cast<int>(gpsd.port), between(1, 65535)));
  if (yaml.has("device")) {
    gpsd.device = yaml.require<std::string>(
        "device", {"the path of a receiver, such as /dev/ttyACM0", is_device});
  }
  return gpsd;
}

}  // namespace

GnssConfig read_gnss(YamlMap& yaml) {
  GnssConfig gnss;
  yaml.require<std::string>("driver", one_of({"gpsd"}));
  gnss.gpsd = read_gpsd_address(yaml);
  const auto antenna_m = yaml.require_list<double>("antenna_m", 2, between(-20.0, 20.0));
  if (antenna_m.size() == 2) gnss.antenna = {antenna_m[0], antenna_m[1]};
  drivers::FixClockParameters& clock = gnss.clock;
  clock.timing = yaml.optional_choice<drivers::FixTiming>(
      "timing", clock.timing,
      {{"arrival", drivers::FixTiming::kArrival},
       {"system_clock", drivers::FixTiming::kSystemClock}});
  if (clock.timing == drivers::FixTiming::kArrival) {
    clock.latency = require_milliseconds(yaml, "latency_ms", between(0.0, 1000.0));
    clock.latency_sigma =
        optional_milliseconds(yaml, "latency_sigma_ms", clock.latency_sigma, between(1.0, 500.0));
  }
  clock.max_age = optional_milliseconds(yaml, "max_age_ms", clock.max_age, between(100.0, 1900.0));
  gnss.min_sigma_m = yaml.optional<double>("min_sigma_m", gnss.min_sigma_m, between(0.01, 100.0));
  if (clock.max_age <= clock.latency) {
    yaml.reject("max_age_ms", "not more than latency_ms", "more than latency_ms");
  }
  return gnss;
}

}  // namespace bevloc::firmware
