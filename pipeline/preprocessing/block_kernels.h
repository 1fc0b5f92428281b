// The box filter over the blocks of a remap table, for CPUs with vectors.
#pragma once

#include <cstdint>

#include "common/image_view.h"
#include "pipeline/preprocessing/format_remap.h"
#include "pipeline/preprocessing/remap_blocks.h"

namespace bevloc {

/// Writes the pixels of all blocks, also those that are left to the plain code: it goes first. The
/// results are those of the plain code, bit by bit.
template <typename Picture>
using BlockKernel = void(const Picture& image, const RemapBlocks& blocks, int8_t* planes);

// The fastest that this CPU can run; null where there is none for such boxes.

BlockKernel<RgbView>* rgb_kernel_for(int taps);
BlockKernel<YuvLayout>* yuv_kernel_for(const YuvLayout& layout, int taps);
BlockKernel<ImageView>* bayer_kernel_for(int taps);

// In AVX2; null elsewhere.

BlockKernel<RgbView>* rgb_kernel_avx2(int taps);
BlockKernel<YuvLayout>* yuv_kernel_avx2(const YuvLayout& layout, int taps);
BlockKernel<ImageView>* bayer_kernel_avx2(int taps);

}  // namespace bevloc
