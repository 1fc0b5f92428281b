// The calls before and after reading dmabuf memory, which the kernel demands for cache coherence.
#pragma once

#include <cerrno>
#include <cstdint>

#include <linux/dma-buf.h>
#include <sys/ioctl.h>

namespace bevloc::drivers {

/// `phase` is DMA_BUF_SYNC_START or DMA_BUF_SYNC_END. Does nothing where caches are coherent.
inline void sync_dmabuf_read(int dmabuf, uint64_t phase) noexcept {
  dma_buf_sync sync{phase | DMA_BUF_SYNC_READ};
  while (ioctl(dmabuf, DMA_BUF_IOCTL_SYNC, &sync) != 0 && (errno == EINTR || errno == EAGAIN)) {
  }
}

/// Call it before the first read of a new image.
inline void begin_dmabuf_read(int dmabuf) noexcept {
  sync_dmabuf_read(dmabuf, DMA_BUF_SYNC_START);
}
/// Call it after the last read.
inline void end_dmabuf_read(int dmabuf) noexcept {
  sync_dmabuf_read(dmabuf, DMA_BUF_SYNC_END);
}

}  // namespace bevloc::drivers
