// Tells harmless warnings of a JPEG decoder from damage.
#pragma once

#include <string_view>

namespace bevloc {

/// TurboJPEG decodes an image to its end, and then fails if libjpeg warned of anything. Some USB
/// cameras send bytes before a marker that belong to no image. libjpeg warns of them, but the image
/// is right. Returns whether the latest decoding of `jpeg` failed only because of such a warning.
/// `decompressor` is the tjhandle.
///
/// libjpeg reports only its first warning, so there may be damage after the extra bytes. Therefore
/// the function also checks that all restart markers are there and in order, and that the end
/// marker follows them. It does not find damage between two restart markers.
bool is_harmless_warning(void* decompressor, std::string_view jpeg);

}  // namespace bevloc
