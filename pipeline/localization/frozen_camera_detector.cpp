#include "pipeline/localization/frozen_camera_detector.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "common/mix.h"

namespace bevloc {
namespace {

/// 128 bits, the vector width that every supported CPU has.
using Words = uint32_t __attribute__((vector_size(16)));
constexpr int kVectors = sizeof(ImageChecksum) / sizeof(Words);

/// For given words this is a bijection of `sums`, so that a difference between two sums is never
/// lost.
inline void add(const int8_t* from, Words& sums) {
  Words words;
  std::memcpy(&words, from, sizeof words);
  sums = ((sums << 5) | (sums >> 27)) + words;
}

uint64_t digest_of(const ImageChecksum& checksum) {
  uint64_t digest = 0;
  for (const uint32_t word : checksum) digest = mix_bits(digest + 0x9e3779b97f4a7c15U + word);
  return digest;
}

}  // namespace

ImageChecksum image_checksum(std::span<const int8_t> planes) {
  assert(planes.size() % sizeof(ImageChecksum) == 0);
  Words sums[kVectors] = {};
  for (size_t i = 0; i < planes.size(); i += sizeof sums) {
    for (int k = 0; k < kVectors; ++k) add(planes.data() + i + k * sizeof(Words), sums[k]);
  }
  ImageChecksum checksum;
  std::memcpy(checksum.data(), sums, sizeof sums);
  return checksum;
}

bool FrozenCameraDetector::is_frozen(int camera, std::span<const int8_t> planes, bool driving) {
  History& history = histories_[camera];
  if (!history.knows(digest_of(image_checksum(planes)))) {
    history.repetitions = 0;
  } else if (driving) {
    history.repetitions = std::min(history.repetitions + 1, kRepetitions);
  }
  return history.repetitions == kRepetitions;
}

bool FrozenCameraDetector::History::knows(Digest image) {
  const auto end = images.begin() + count;
  if (std::find(images.begin(), end, image) != end) return true;
  if (count < kRemembered) {
    images[count++] = image;
  } else {
    images[oldest] = image;
    oldest = (oldest + 1) % kRemembered;
  }
  return false;
}

}  // namespace bevloc
