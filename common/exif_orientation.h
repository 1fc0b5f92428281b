// Reads from a JPEG how a viewer turns its picture.
#pragma once

#include <optional>
#include <string_view>

namespace bevloc {

/// The value of the EXIF tag Orientation (0x0112), 1 to 8. 1 means that the stored picture is
/// upright; the other values demand a turn or a mirror image. Returns nothing if `jpeg` has no such
/// tag, is cut off before it, or is damaged there.
std::optional<int> exif_orientation(std::string_view jpeg);

}  // namespace bevloc
