// What a machine offers for a configuration: cameras and CAN interfaces.
#pragma once

#include <string>
#include <vector>

#include "command/doctor/machine.h"

namespace bevloc::command {

/// A camera that is there.
struct OfferedCamera {
  std::string id;    ///< as cameras.ids takes it
  std::string name;  ///< such as "HD USB Camera"
};

struct Offers {
  std::vector<OfferedCamera> v4l2;
  std::vector<OfferedCamera> libcamera;
  std::vector<std::string> can_interfaces;
};

/// Looks for devices. `libcamera_ids` are those that libcamera lists, which needs no machine.
Offers offers_of(const Machine& machine, const std::vector<std::string>& libcamera_ids);

/// libcamera's cameras; none if this program was built without libcamera.
std::vector<std::string> libcamera_ids_of_this_machine();

}  // namespace bevloc::command
