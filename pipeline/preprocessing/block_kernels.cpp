#include "pipeline/preprocessing/block_kernels.h"

#include "common/cpu_features.h"

namespace bevloc {

#if !defined(__x86_64__) && !defined(__aarch64__)
BlockKernel<RgbView>* rgb_block_kernel(int) {
  return nullptr;
}
BlockKernel<YuvLayout>* yuv_block_kernel(const YuvLayout&, int) {
  return nullptr;
}
BlockKernel<ImageView>* bayer_block_kernel(int) {
  return nullptr;
}
#endif

bool can_run_block_kernels() {
#if defined(__x86_64__)
  return has_avx2();
#elif defined(__aarch64__)
  return has_dot_product();
#else
  return false;
#endif
}

BlockKernel<RgbView>* rgb_kernel_for(int taps) {
  return can_run_block_kernels() ? rgb_block_kernel(taps) : nullptr;
}
BlockKernel<YuvLayout>* yuv_kernel_for(const YuvLayout& layout, int taps) {
  return can_run_block_kernels() ? yuv_block_kernel(layout, taps) : nullptr;
}
BlockKernel<ImageView>* bayer_kernel_for(int taps) {
  return can_run_block_kernels() ? bayer_block_kernel(taps) : nullptr;
}

}  // namespace bevloc
