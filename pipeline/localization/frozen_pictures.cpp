#include "pipeline/localization/frozen_pictures.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace bevloc {
namespace {

/// What every CPU has registers for.
using Words = uint32_t __attribute__((vector_size(16)));
constexpr int kVectors = sizeof(PictureChecksum) / sizeof(Words);

/// For fixed words each sum has one successor and one predecessor: a difference stays one.
inline void add(const int8_t* from, Words& sums) {
  Words words;
  std::memcpy(&words, from, sizeof words);
  sums = ((sums << 5) | (sums >> 27)) + words;
}

}  // namespace

PictureChecksum picture_checksum(std::span<const int8_t> planes) {
  assert(planes.size() % sizeof(PictureChecksum) == 0);
  Words sums[kVectors] = {};
  for (size_t i = 0; i < planes.size(); i += sizeof sums) {
    for (int k = 0; k < kVectors; ++k) add(planes.data() + i + k * sizeof(Words), sums[k]);
  }
  PictureChecksum checksum;
  std::memcpy(checksum.data(), sums, sizeof sums);
  return checksum;
}

bool FrozenPictures::is_frozen(int camera, std::span<const int8_t> planes, bool driving) {
  History& history = histories_[camera];
  const PictureChecksum checksum = picture_checksum(planes);
  if (history.latest != checksum) {
    history.latest = checksum;
    history.repetitions = 0;
  } else if (driving) {
    history.repetitions = std::min(history.repetitions + 1, kRepetitions);
  }
  return history.repetitions == kRepetitions;
}

}  // namespace bevloc
