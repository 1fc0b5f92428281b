#include "training/native/sample_record.h"

#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <string_view>

#include "pipeline/bev_grid.h"
#include "pipeline/preprocessing/image_remap.h"

namespace bevloc {

static_assert(std::endian::native == std::endian::little);

namespace {

constexpr std::string_view kMagic = "bevlocS1";
constexpr size_t kImageBytes = kCameraCount * kNetworkImageSize;
constexpr size_t kTableEntries = static_cast<size_t>(kViewSlots) * kFeatureGrid.cells();
constexpr size_t kRasterBytes = static_cast<size_t>(kRasterChannels) * kRasterGrid.cells();

/// Appends bytes to memory of fixed size.
class Bytes {
 public:
  explicit Bytes(std::vector<uint8_t>& bytes) : bytes_(bytes) {}

  template <typename Value>
  void add(const Value* values, size_t count) {
    assert(position_ + count * sizeof(Value) <= bytes_.size());
    std::memcpy(bytes_.data() + position_, values, count * sizeof(Value));
    position_ += count * sizeof(Value);
  }

 private:
  std::vector<uint8_t>& bytes_;
  size_t position_ = 0;
};

}  // namespace

std::vector<uint8_t> sample_stream_header() {
  const std::array<uint32_t, 8> sizes = {
      kCameraCount,     kNetworkHeightPx,
      kNetworkWidthPx,  kRasterChannels,
      kRasterGrid.rows, kRasterGrid.cols,
      kViewSlots,       static_cast<uint32_t>(kFeatureGrid.cells())};
  std::vector<uint8_t> header(kMagic.size() + sizeof(sizes));
  Bytes bytes(header);
  bytes.add(kMagic.data(), kMagic.size());
  bytes.add(sizes.data(), sizes.size());
  return header;
}

size_t sample_record_size() {
  return kImageBytes + 2 * kRasterBytes + kTableEntries * (sizeof(int32_t) + sizeof(float)) +
         3 * sizeof(float) + sizeof(uint32_t);
}

void write_sample_record(const SampleContent& sample, std::vector<uint8_t>& record) {
  record.resize(sample_record_size());
  Bytes bytes(record);
  bytes.add(sample.images.data(), kImageBytes);
  bytes.add(sample.raster_prior.data(), kRasterBytes);
  bytes.add(sample.raster_truth.data(), kRasterBytes);
  bytes.add(sample.table.index.data(), kTableEntries);
  bytes.add(sample.table.weight.data(), kTableEntries);
  const std::array<float, 3> correction = {static_cast<float>(sample.correction.x_m),
                                           static_cast<float>(sample.correction.y_m),
                                           static_cast<float>(sample.correction.yaw_rad)};
  bytes.add(correction.data(), correction.size());
  const auto cameras = static_cast<uint32_t>(sample.cameras.to_ulong());
  bytes.add(&cameras, 1);
}

}  // namespace bevloc
