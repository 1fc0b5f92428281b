#include "common/jpeg.h"

#include <turbojpeg.h>

#include "common/jpeg_warning.h"
#include "common/rgb_conversion.h"

namespace bevloc {
struct JpegEncoder::Handle {
  tjhandle compressor = tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): TurboJPEG's type
  Handle() = default;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    tjFree(bytes);
    tjDestroy(compressor);
  }
};

JpegEncoder::JpegEncoder() : handle_(std::make_unique<Handle>()) {}
JpegEncoder::~JpegEncoder() = default;

bool can_encode_jpeg(PixelFormat format) {
  return format == PixelFormat::kRgb24 || format == PixelFormat::kYuyv ||
         format == PixelFormat::kUyvy || format == PixelFormat::kNv12;
}

Result<std::string_view> JpegEncoder::encode(const ImageView& image, int quality) {
  if (!can_encode_jpeg(image.format)) {
    return fail("image: found the format {}, wanted rgb24, yuyv, uyvy or nv12 to make a JPEG of",
                to_string(image.format));
  }
  RgbView source{image.planes[0].data, image.width, image.height, image.planes[0].stride_bytes};
  if (image.format != PixelFormat::kRgb24) {
    if (rgb_.width != image.width || rgb_.height != image.height) {
      rgb_ = RgbImage::uninitialized(image.width, image.height);
    }
    convert_to_rgb(image, rgb_);
    source = rgb_.view();
  }
  if (tjCompress2(handle_->compressor, source.data, source.width,
                  static_cast<int>(source.stride_bytes), source.height, TJPF_RGB, &handle_->bytes,
                  &handle_->size, TJSAMP_420, quality, 0) != 0) {
    return fail("image: cannot make a JPEG ({})", tjGetErrorStr2(handle_->compressor));
  }
  return std::string_view(reinterpret_cast<const char*>(handle_->bytes), handle_->size);
}

JpegDecoder::JpegDecoder() : decompressor_(tjInitDecompress(), tjDestroy) {}

Status JpegDecoder::open(std::string_view file, std::string_view place) {
  file_ = file;
  place_ = place;
  int subsampling = 0;
  int colours = 0;
  if (tjDecompressHeader3(decompressor_.get(), reinterpret_cast<const uint8_t*>(file.data()),
                          file.size(), &width_px_, &height_px_, &subsampling, &colours) != 0) {
    return damaged();
  }
  return {};
}

Status JpegDecoder::decode(RgbImage& image) {
  // Any other warning counts as an error: data is corrupt or cut off, and the rest is grey.
  if (tjDecompress2(decompressor_.get(), reinterpret_cast<const uint8_t*>(file_.data()),
                    file_.size(), image.row(0), image.width, 0, image.height, TJPF_RGB, 0) != 0 &&
      !is_harmless_warning(decompressor_.get(), file_)) {
    return damaged();
  }
  return {};
}

Status JpegDecoder::damaged() const {
  return fail("{}: found a damaged JPEG ({}), wanted a whole one", place_,
              tjGetErrorStr2(decompressor_.get()));
}

Result<RgbImage> decode_jpeg(std::string_view bytes, std::string_view place) {
  JpegDecoder decoder;
  if (Status opened = decoder.open(bytes, place); !opened) return tl::unexpected(opened.error());
  const int width = decoder.width_px();
  const int height = decoder.height_px();
  constexpr int kMostPixels = 1 << 26;
  if (width <= 0 || height <= 0 || width > kMostPixels / height) {
    return fail("{}: found a JPEG of {}x{} pixels, wanted 1 to {} pixels in all", place, width,
                height, kMostPixels);
  }
  RgbImage image = RgbImage::uninitialized(width, height);
  if (Status decoded = decoder.decode(image); !decoded) return tl::unexpected(decoded.error());
  return image;
}

}  // namespace bevloc
