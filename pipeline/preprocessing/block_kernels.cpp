#include "pipeline/preprocessing/block_kernels.h"

namespace bevloc {
namespace {

bool has_avx2() {
#ifdef __x86_64__
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

}  // namespace

#ifndef __x86_64__
BlockKernel<RgbView>* rgb_kernel_avx2(int) {
  return nullptr;
}
BlockKernel<YuvLayout>* yuv_kernel_avx2(const YuvLayout&, int) {
  return nullptr;
}
BlockKernel<ImageView>* bayer_kernel_avx2(int) {
  return nullptr;
}
#endif

BlockKernel<RgbView>* rgb_kernel_for(int taps) {
  return has_avx2() ? rgb_kernel_avx2(taps) : nullptr;
}
BlockKernel<YuvLayout>* yuv_kernel_for(const YuvLayout& layout, int taps) {
  return has_avx2() ? yuv_kernel_avx2(layout, taps) : nullptr;
}
BlockKernel<ImageView>* bayer_kernel_for(int taps) {
  return has_avx2() ? bayer_kernel_avx2(taps) : nullptr;
}

}  // namespace bevloc
