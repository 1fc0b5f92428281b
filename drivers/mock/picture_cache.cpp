#include "drivers/mock/picture_cache.h"

#include <algorithm>

namespace bevloc::drivers {

bool PictureCache::find(uint64_t key, RgbImage& image) {
  const std::lock_guard lock(mutex_);
  const auto known = pictures_.find(key);
  if (known == pictures_.end() || known->second.size() != image.pixels.size()) return false;
  std::ranges::copy(known->second, image.pixels.begin());
  ++counters_.found;
  return true;
}

void PictureCache::keep(uint64_t key, const RgbImage& image) {
  const std::lock_guard lock(mutex_);
  if (counters_.bytes + image.pixels.size() > max_bytes_) return;
  const auto [kept, is_new] = pictures_.try_emplace(key, image.pixels);
  if (!is_new) return;
  ++counters_.kept;
  counters_.bytes += kept->second.size();
}

void PictureCache::clear() {
  const std::lock_guard lock(mutex_);
  pictures_.clear();
  counters_.bytes = 0;
}

PictureCache::Counters PictureCache::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace bevloc::drivers
