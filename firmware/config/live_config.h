// The section `live` of the configuration file: the HTTP server with the live page and the metrics.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/result.h"
#include "common/strict_yaml.h"

namespace bevloc::firmware {

struct LiveConfig {
  std::string address = "127.0.0.1";  ///< an IPv4 or IPv6 address in numbers
  int port = 8080;
  bool open_to_network = false;  ///< allows an address beyond this machine
};

/// Whether `text` is an IP address of this machine alone: 127.0.0.0/8 or ::1.
bool is_loopback(const std::string& text);

/// Whether `text` is an IPv4 or IPv6 address in numbers.
bool is_ip_address(const std::string& text);

/// Reads the section. Returns nothing if there is none. Refuses an address beyond this machine
/// unless `open_to_network` is set, because the server asks nobody for a password.
/// YamlMap::finish() reports mistakes.
std::optional<LiveConfig> read_live(std::optional<YamlMap> yaml);

/// Returns the text after `http://` for this server.
std::string authority_of(const LiveConfig& config);

}  // namespace bevloc::firmware
