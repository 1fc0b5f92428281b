// The cameras and CAN interfaces that a machine offers for a configuration.
#pragma once

#include <string>
#include <vector>

#include "command/doctor/machine.h"

namespace bevloc::command {

/// A camera that is connected.
struct OfferedCamera {
  std::string id;    ///< the id for cameras.ids
  std::string name;  ///< such as "HD USB Camera"
};

struct Offers {
  std::vector<OfferedCamera> v4l2;
  std::vector<OfferedCamera> libcamera;
  std::vector<std::string> can_interfaces;
};

/// Looks for devices. `libcamera_ids` are the ids of libcamera's cameras, which the caller has
/// looked up.
Offers offers_of(const Machine& machine, const std::vector<std::string>& libcamera_ids);

/// Returns the ids of libcamera's cameras, or none if this program was built without libcamera.
std::vector<std::string> libcamera_ids_of_this_machine();

}  // namespace bevloc::command
