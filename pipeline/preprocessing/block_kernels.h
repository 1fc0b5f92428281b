// Vectorised kernels of the box filter, which process the blocks of a remap table.
#pragma once

#include <cstdint>

#include "common/image_view.h"
#include "pipeline/preprocessing/format_remap.h"
#include "pipeline/preprocessing/remap_blocks.h"

namespace bevloc {

/// Writes all pixels of all blocks, with the same bits as the plain code. It also overwrites the
/// pixels in a block that only the plain code can compute, so it must run before the plain code.
template <typename Image>
using BlockKernel = void(const Image& image, const RemapBlocks& blocks, int8_t* planes);

// The fastest kernel for this CPU; null if there is none for `taps` or for the layout.

BlockKernel<RgbView>* rgb_kernel_for(int taps);
BlockKernel<YuvLayout>* yuv_kernel_for(const YuvLayout& layout, int taps);
BlockKernel<ImageView>* bayer_kernel_for(int taps);

// The kernels for AVX2; null if the program is not built for x86-64.

BlockKernel<RgbView>* rgb_kernel_avx2(int taps);
BlockKernel<YuvLayout>* yuv_kernel_avx2(const YuvLayout& layout, int taps);
BlockKernel<ImageView>* bayer_kernel_avx2(int taps);

}  // namespace bevloc
