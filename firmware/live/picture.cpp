#include "firmware/live/picture.h"

#include "common/rgb_conversion.h"

namespace bevloc::firmware {
namespace {

constexpr int kQuality = 72;

int reduction_for(int width_px) {
  return (width_px + PictureMaker::kMaxWidth_px - 1) / PictureMaker::kMaxWidth_px;
}

}  // namespace

Status PictureMaker::read_jpeg(const ImageView& image) {
  const auto* const file = reinterpret_cast<const char*>(image.planes[0].data);
  if (Status opened = decoder_.open({file, image.bytes_used}, "live"); !opened) return opened;
  const int width = decoder_.width_px();
  const int height = decoder_.height_px();
  if (width != image.width || height != image.height) {
    return fail("live: found a JPEG of {} x {} pixels, wanted one of {} x {} pixels", width, height,
                image.width, image.height);
  }
  // The decoder reduces by 1, 2, 4 or 8.
  int reduction = 1;
  while (reduction < 8 && width / reduction > kMaxWidth_px) reduction *= 2;
  small_ = RgbImage::uninitialized((width + reduction - 1) / reduction,
                                   (height + reduction - 1) / reduction);
  return decoder_.decode(small_);
}

Status PictureMaker::read(const ImageView& image) {
  if (image.width < 2 || image.height < 2) {
    return fail("live: found an image of {} x {} pixels, wanted at least 2 x 2", image.width,
                image.height);
  }
  if (image.format == PixelFormat::kMjpeg) return read_jpeg(image);
  const int reduction = reduction_for(image.width);
  small_ = RgbImage::uninitialized(image.width / reduction, image.height / reduction);
  convert_to_rgb(image, small_, reduction);
  return {};
}

Result<std::string> PictureMaker::jpeg_of(const ImageView& image) {
  if (const Status status = read(image); !status) return tl::unexpected(status.error());
  const auto jpeg = encoder_.encode(small_.view(), kQuality);
  if (!jpeg) return tl::unexpected(jpeg.error());
  return std::string(*jpeg);
}

}  // namespace bevloc::firmware
