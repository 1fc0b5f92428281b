// Tells harmless warnings of a JPEG decoder from damage.
#pragma once

#include <string_view>

namespace bevloc {

/// TurboJPEG decodes an image to its end, and then fails if libjpeg warned of anything. Some USB
/// cameras send bytes before a marker that belong to no image. libjpeg warns of them, but the image
/// is right. Returns whether the latest decoding of `jpeg` failed only because of such a warning.
/// `decompressor` is the tjhandle.
///
/// libjpeg tells its first warning only. So this function checks that the restart markers are
/// complete and in order, and that the end marker is there. Damage between two restart markers is
/// not found in an image with such bytes.
bool is_harmless_warning(void* decompressor, std::string_view jpeg);

}  // namespace bevloc
