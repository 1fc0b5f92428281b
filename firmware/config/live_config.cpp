#include "firmware/config/live_config.h"

#include <array>
#include <cstring>

#include <arpa/inet.h>
#include <netinet/in.h>

namespace bevloc::firmware {
namespace {

struct IpAddress {
  int family = AF_UNSPEC;
  std::array<uint8_t, sizeof(in6_addr)> bytes{};
};

IpAddress ip_address_of(const std::string& text) {
  IpAddress address;
  for (const int family : {AF_INET, AF_INET6}) {
    if (inet_pton(family, text.c_str(), address.bytes.data()) == 1) {
      address.family = family;
      break;
    }
  }
  return address;
}

}  // namespace

bool is_ip_address(const std::string& text) {
  return ip_address_of(text).family != AF_UNSPEC;
}

bool is_loopback(const std::string& text) {
  const IpAddress address = ip_address_of(text);
  if (address.family == AF_INET) return address.bytes[0] == 127;
  return address.family == AF_INET6 &&
         std::memcmp(address.bytes.data(), &in6addr_loopback, sizeof in6addr_loopback) == 0;
}

std::optional<LiveConfig> read_live(std::optional<YamlMap> yaml) {
  if (!yaml) return std::nullopt;
  LiveConfig live;
  const Wanted<std::string> address{"an IP address in numbers, such as 127.0.0.1 or ::1",
                                    is_ip_address};
  live.address = yaml->optional<std::string>("address", live.address, address);
  live.port = yaml->optional<int>("port", live.port, between(1, 65535));
  live.open_to_network = yaml->optional<bool>("open_to_network", live.open_to_network);
  if (is_ip_address(live.address) && !is_loopback(live.address) && !live.open_to_network) {
    yaml->reject("address", live.address + ", which other machines reach",
                 "a loopback address, or open_to_network: true");
  }
  return live;
}

std::string authority_of(const LiveConfig& config) {
  const bool ipv6 = config.address.find(':') != std::string::npos;
  return fmt::format("{}{}{}:{}", ipv6 ? "[" : "", config.address, ipv6 ? "]" : "", config.port);
}

}  // namespace bevloc::firmware
