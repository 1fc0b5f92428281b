// Reading memory that devices share, by the kernel's rules for dmabuf.
#pragma once

#include <cerrno>
#include <cstdint>

#include <linux/dma-buf.h>
#include <sys/ioctl.h>

namespace bevloc::drivers {

/// Before the first read of a new picture, and after the last. A no-op where caches are coherent.
inline void begin_dmabuf_read(int dmabuf, uint64_t phase = DMA_BUF_SYNC_START) noexcept {
  dma_buf_sync sync{phase | DMA_BUF_SYNC_READ};
  while (ioctl(dmabuf, DMA_BUF_IOCTL_SYNC, &sync) != 0 && (errno == EINTR || errno == EAGAIN)) {
  }
}
inline void end_dmabuf_read(int dmabuf) noexcept {
  begin_dmabuf_read(dmabuf, DMA_BUF_SYNC_END);
}

}  // namespace bevloc::drivers
