// Reading memory that devices share, by the kernel's rules for dmabuf.
#pragma once

#include <cerrno>
#include <cstdint>

#include <linux/dma-buf.h>
#include <sys/ioctl.h>

namespace bevloc::drivers {

/// `phase` is DMA_BUF_SYNC_START or DMA_BUF_SYNC_END. A no-op where caches are coherent.
inline void sync_dmabuf_read(int dmabuf, uint64_t phase) noexcept {
  dma_buf_sync sync{phase | DMA_BUF_SYNC_READ};
  while (ioctl(dmabuf, DMA_BUF_IOCTL_SYNC, &sync) != 0 && (errno == EINTR || errno == EAGAIN)) {
  }
}

/// Before the first read of a new picture, and after the last.
inline void begin_dmabuf_read(int dmabuf) noexcept {
  sync_dmabuf_read(dmabuf, DMA_BUF_SYNC_START);
}
inline void end_dmabuf_read(int dmabuf) noexcept {
  sync_dmabuf_read(dmabuf, DMA_BUF_SYNC_END);
}

}  // namespace bevloc::drivers
