#include "pipeline/preprocessing/format_remap.h"

#include "pipeline/preprocessing/block_kernels.h"

namespace bevloc {
namespace {

template <typename Image>
using Plain = void(const Image& image, const RemapTable& table, PixelRange range, int8_t* planes);

/// Runs the kernel for the blocks and the plain code for the other pixels.
template <typename Image>
void remap(BlockKernel<Image>* kernel, Plain<Image>& plain, const Image& image,
           const RemapTable& table, int8_t* planes) {
  if (kernel == nullptr) return plain(image, table, kAllNetworkPixels, planes);
  kernel(image, table.blocks, planes);
  for (const PixelRange range : table.blocks.others) plain(image, table, range, planes);
}

}  // namespace

void remap_rgb(const RgbView& image, const RemapTable& table, int8_t* planes) {
  remap(rgb_kernel_for(table.taps), remap_rgb_plain, image, table, planes);
}

void remap_yuv(const YuvLayout& image, const RemapTable& table, int8_t* planes) {
  remap(yuv_kernel_for(image, table.taps), remap_yuv_plain, image, table, planes);
}

void remap_bayer(const ImageView& image, const RemapTable& table, int8_t* planes) {
  remap(bayer_kernel_for(table.taps), remap_bayer_plain, image, table, planes);
}

}  // namespace bevloc
