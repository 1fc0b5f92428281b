#include "can/vehicle/vehicle_binding.h"

#include <algorithm>

#include <fmt/format.h>

#include "can/bus/frame.h"

namespace bevloc::can {

std::vector<uint32_t> ids_of(const VehicleBinding& binding) {
  std::vector<uint32_t> ids;
  for (const BoundMessage& message : binding.messages) ids.push_back(message.id);
  return ids;
}

bool needs_fd(const VehicleBinding& binding) {
  return std::ranges::any_of(binding.messages, [](const BoundMessage& message) {
    return !is_valid_length(FrameFormat::kClassic, message.length);
  });
}

std::vector<std::string> warnings_of(const VehicleBinding& binding) {
  std::vector<std::string> warnings;
  for (const BoundMessage& message : binding.messages) {
    const MessageProtection& protection = message.protection;
    if (!protection.has_counter()) {
      warnings.push_back(fmt::format(
          "{}: message {} has no counter, so a sender that repeats an old frame is not noticed",
          binding.dbc_file, message.name));
    }
    if (protection.checksum == ChecksumKind::kNone) {
      warnings.push_back(fmt::format(
          "{}: message {} has no checksum, so a frame that was damaged before it was sent is not "
          "noticed",
          binding.dbc_file, message.name));
    }
  }
  return warnings;
}

}  // namespace bevloc::can
