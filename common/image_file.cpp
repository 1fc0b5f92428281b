#include "common/image_file.h"

#include <png.h>

#include "common/exif_orientation.h"
#include "common/files.h"
#include "common/jpeg.h"

namespace bevloc {
namespace {

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegSignature = "\xff\xd8\xff";

/// Owns the state that libpng keeps for one file.
class PngImage {
 public:
  PngImage() { image_.version = PNG_IMAGE_VERSION; }
  ~PngImage() { png_image_free(&image_); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;

  png_image* operator->() { return &image_; }
  png_imagep get() { return &image_; }

 private:
  png_image image_{};
};

/// An image file, and what error messages say about it.
struct ImageSource {
  const std::string& path;
  std::string_view size_from = "";  ///< where the wanted size comes from
};

Status check_size(const ImageSource& source, int width, int height, const RgbImage& wanted) {
  if (width == wanted.width && height == wanted.height) return {};
  return fail("{}: found an image of {}x{} pixels, wanted {}x{}{}", source.path, width, height,
              wanted.width, wanted.height, source.size_from);
}

Status read_png(const ImageSource& source, const std::string& bytes, RgbImage& image) {
  PngImage png;
  if (png_image_begin_read_from_memory(png.get(), bytes.data(), bytes.size()) == 0) {
    return fail("{}: found a damaged PNG file ({}), wanted a complete one", source.path,
                png->message);
  }
  const Status size =
      check_size(source, static_cast<int>(png->width), static_cast<int>(png->height), image);
  if (!size) return size;
  png->format = PNG_FORMAT_RGB;
  // Without this flag libpng assumes that 16-bit samples are linear if the file states no gamma.
  png->flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
  constexpr png_color kBlack{0, 0, 0};
  if (png_image_finish_read(png.get(), &kBlack, image.pixels.data(), 0, nullptr) == 0) {
    return fail("{}: found a damaged PNG file ({}), wanted a complete one", source.path,
                png->message);
  }
  return {};
}

Status read_jpeg(const ImageSource& source, const std::string& bytes, RgbImage& image) {
  JpegDecoder decoder;
  if (const Status opened = decoder.open(bytes, source.path); !opened) return opened;
  const Status size = check_size(source, decoder.width_px(), decoder.height_px(), image);
  return size ? decoder.decode(image) : size;
}

Status read_bytes(const ImageSource& source, const std::string& bytes, RgbImage& image) {
  if (bytes.starts_with(kPngSignature)) return read_png(source, bytes, image);
  if (bytes.starts_with(kJpegSignature)) return read_jpeg(source, bytes, image);
  return fail("{}: found a file that is neither PNG nor JPEG, wanted an image", source.path);
}

}  // namespace

Status read_image(const std::string& path, RgbImage& image) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return read_bytes({path}, *bytes, image);
}

Status read_camera_picture(const std::string& path, RgbImage& image) {
  constexpr int kUpright = 1;
  const Result<std::string> bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  const int orientation = exif_orientation(*bytes).value_or(kUpright);
  if (orientation != kUpright) {
    return fail(
        "{}: found EXIF orientation {}, wanted {}: store the picture turned, or remove the tag if "
        "the calibration is of the stored pixels",
        path, orientation, kUpright);
  }
  return read_bytes(
      {path, " as image_size_px in the rig; pictures of another size need another calibration"},
      *bytes, image);
}

Status write_png(const RgbView& image, const std::string& path) {
  PngImage png;
  png->width = static_cast<png_uint_32>(image.width);
  png->height = static_cast<png_uint_32>(image.height);
  png->format = PNG_FORMAT_RGB;
  if (png_image_write_to_file(png.get(), path.c_str(), 0, image.data,
                              static_cast<png_int_32>(image.stride_bytes), nullptr) == 0) {
    return fail("{}: cannot write the image to this file ({})", path, png->message);
  }
  return {};
}

}  // namespace bevloc
