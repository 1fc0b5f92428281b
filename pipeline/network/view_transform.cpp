#include "pipeline/network/view_transform.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "common/target_clones.h"

namespace bevloc::nn {
namespace {

constexpr int kLanes = 16;
using FloatLanes = float __attribute__((vector_size(kLanes * sizeof(float))));
using IntLanes = int32_t __attribute__((vector_size(kLanes * sizeof(int32_t))));
template <typename Element>
using LanesOf __attribute__((vector_size(kLanes * sizeof(Element)))) = Element;

/// Adding and taking away 1.5 * 2^23 rounds a small float to the nearest even integer.
constexpr float kRounder = 12582912.0F;

template <typename Output>
[[gnu::always_inline]] inline void store(const FloatLanes& exact, Output* output) {
  if constexpr (std::is_same_v<Output, float>) {
    std::memcpy(output, &exact, sizeof(exact));
  } else {
    constexpr float kLowest = std::numeric_limits<Output>::min();
    constexpr float kHighest = std::numeric_limits<Output>::max();
    FloatLanes inside = exact < kLowest ? FloatLanes{} + kLowest : exact;
    inside = inside > kHighest ? FloatLanes{} + kHighest : inside;
    const auto rounded = __builtin_convertvector((inside + kRounder) - kRounder, IntLanes);
    const auto narrow = __builtin_convertvector(rounded, LanesOf<Output>);
    std::memcpy(output, &narrow, sizeof(narrow));
  }
}

template <typename Output>
[[gnu::always_inline]] inline Output narrowed(float sum) {
  if constexpr (std::is_same_v<Output, float>) {
    return sum;
  } else {
    constexpr float kLowest = std::numeric_limits<Output>::min();
    constexpr float kHighest = std::numeric_limits<Output>::max();
    return static_cast<Output>((std::clamp(sum, kLowest, kHighest) + kRounder) - kRounder);
  }
}

/// Sixteen channels of one cell in registers; channels that are left over, one by one.
template <typename Input, typename Output>
[[gnu::always_inline]] inline void gather_cells(const ViewEntries& entries, const Input* features,
                                                int channels, float scale, int begin, int end,
                                                Output* bev) {
  const int whole_lanes = channels / kLanes * kLanes;
  for (int cell = begin; cell < end; ++cell) {
    const int32_t first = entries.first()[cell];
    const int32_t last = entries.first()[cell + 1];
    Output* const output = bev + static_cast<size_t>(cell) * channels;
    for (int channel = 0; channel < whole_lanes; channel += kLanes) {
      FloatLanes sum{};
      for (int32_t entry = first; entry < last; ++entry) {
        LanesOf<Input> feature;
        std::memcpy(&feature,
                    features + static_cast<size_t>(entries.index()[entry]) * channels + channel,
                    sizeof(feature));
        sum += entries.weight()[entry] * __builtin_convertvector(feature, FloatLanes);
      }
      store(sum * scale, output + channel);
    }
    for (int channel = whole_lanes; channel < channels; ++channel) {
      float sum = 0.0F;
      for (int32_t entry = first; entry < last; ++entry) {
        const size_t key = static_cast<size_t>(entries.index()[entry]);
        sum += entries.weight()[entry] * static_cast<float>(features[key * channels + channel]);
      }
      output[channel] = narrowed<Output>(sum * scale);
    }
  }
}

}  // namespace

ViewEntries::ViewEntries(int cells)
    : first_(static_cast<size_t>(cells) + 1),
      index_(static_cast<size_t>(cells) * kViewSlots),
      weight_(static_cast<size_t>(cells) * kViewSlots) {}

void ViewEntries::set(const ViewTable& table) {
  const size_t cell_count = static_cast<size_t>(cells());
  assert(table.index.size() == kViewSlots * cell_count);
  assert(table.weight.size() == kViewSlots * cell_count);
  int32_t entry = 0;
  for (size_t cell = 0; cell < cell_count; ++cell) {
    first_[cell] = entry;
    for (size_t slot = 0; slot < kViewSlots; ++slot) {
      const size_t from = slot * cell_count + cell;
      if (table.weight[from] == 0.0F) continue;
      index_[entry] = table.index[from];
      weight_[entry] = table.weight[from];
      ++entry;
    }
  }
  first_[cell_count] = entry;
}

// A template cannot be cloned for several instruction sets, its named instances can.
#define BEVLOC_GATHER_VIEW(Input, Output)                                                  \
  template <>                                                                              \
  BEVLOC_TARGET_CLONES void gather_view(const ViewEntries& entries, const Input* features, \
                                        int channels, float scale, int begin, int end,     \
                                        Output* bev) {                                     \
    gather_cells(entries, features, channels, scale, begin, end, bev);                     \
  }
BEVLOC_GATHER_VIEW(uint8_t, uint8_t)
BEVLOC_GATHER_VIEW(uint8_t, int8_t)
BEVLOC_GATHER_VIEW(uint8_t, float)
BEVLOC_GATHER_VIEW(int8_t, uint8_t)
BEVLOC_GATHER_VIEW(int8_t, int8_t)
BEVLOC_GATHER_VIEW(int8_t, float)
BEVLOC_GATHER_VIEW(float, uint8_t)
BEVLOC_GATHER_VIEW(float, int8_t)
BEVLOC_GATHER_VIEW(float, float)
#undef BEVLOC_GATHER_VIEW

}  // namespace bevloc::nn
