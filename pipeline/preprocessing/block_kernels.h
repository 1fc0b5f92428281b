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

/// Whether this CPU has the instructions of the kernels: AVX2, or on arm64 FEAT_DotProd.
bool can_run_block_kernels();

// The kernel for this CPU, or null if there is none for `taps` or for the layout, or if the CPU
// cannot run it.

BlockKernel<RgbView>* rgb_kernel_for(int taps);
BlockKernel<YuvLayout>* yuv_kernel_for(const YuvLayout& layout, int taps);
BlockKernel<ImageView>* bayer_kernel_for(int taps);

// The kernel for the processor family that the program is built for, whether or not this CPU can
// run it. Each family defines them in files of its own.

BlockKernel<RgbView>* rgb_block_kernel(int taps);
BlockKernel<YuvLayout>* yuv_block_kernel(const YuvLayout& layout, int taps);
BlockKernel<ImageView>* bayer_block_kernel(int taps);

}  // namespace bevloc
