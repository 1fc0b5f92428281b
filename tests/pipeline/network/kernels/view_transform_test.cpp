#include "pipeline/network/kernels/view_transform.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

#include <gtest/gtest.h>

#include "pipeline/network/kernels/view_gather.h"
#include "tests/pipeline/network/model_inputs.h"

namespace bevloc::nn {
namespace {

constexpr int kCells = 53;
constexpr int kKeys = 40;

template <typename Element>
std::vector<Element> features(int channels) {
  std::vector<Element> values;
  for (int i = 0; i < kKeys * channels; ++i) {
    values.push_back(static_cast<Element>(test::hashed(static_cast<uint32_t>(i), 5) >> 24));
  }
  return values;
}

/// The view transform by definition, one element after the other.
template <typename Input, typename Output>
std::vector<Output> scalar_twin(const ViewTable& table, const std::vector<Input>& input,
                                int channels, float scale) {
  std::vector<Output> bev;
  for (int cell = 0; cell < kCells; ++cell) {
    for (int channel = 0; channel < channels; ++channel) {
      float sum = 0.0F;
      for (int slot = 0; slot < kViewSlots; ++slot) {
        const size_t entry = static_cast<size_t>(slot * kCells + cell);
        const size_t key = static_cast<size_t>(table.index[entry]);
        // volatile prevents the compiler from fusing the product into the sum.
        volatile float product =
            table.weight[entry] * static_cast<float>(input[key * channels + channel]);
        sum = sum + product;
      }
      sum *= scale;
      if constexpr (!std::is_same_v<Output, float>) {
        sum = std::nearbyint(std::clamp<float>(sum, std::numeric_limits<Output>::min(),
                                               std::numeric_limits<Output>::max()));
      }
      bev.push_back(static_cast<Output>(sum));
    }
  }
  return bev;
}

template <typename Element>
constexpr ElementType type_of() {
  if (std::is_same_v<Element, uint8_t>) return ElementType::kUint8;
  return std::is_same_v<Element, int8_t> ? ElementType::kInt8 : ElementType::kFloat32;
}

template <typename Input, typename Output>
void gather(const ViewEntries& entries, const std::vector<Input>& features, int channels,
            float scale, int begin, int end, std::vector<Output>& bev) {
  gather_view(entries, type_of<Input>(), std::as_bytes(std::span(features)).data(), channels, scale,
              begin, end, type_of<Output>(), std::as_writable_bytes(std::span(bev)).data());
}

template <typename Types>
class ViewTransform : public ::testing::Test {};

template <typename I, typename O>
struct Pair {
  using Input = I;
  using Output = O;
};
using AllTypes =
    ::testing::Types<Pair<uint8_t, uint8_t>, Pair<uint8_t, int8_t>, Pair<uint8_t, float>,
                     Pair<int8_t, uint8_t>, Pair<int8_t, int8_t>, Pair<int8_t, float>,
                     Pair<float, uint8_t>, Pair<float, int8_t>, Pair<float, float>>;
TYPED_TEST_SUITE(ViewTransform, AllTypes);

TYPED_TEST(ViewTransform, EqualsItsScalarTwin) {
  using Input = typename TypeParam::Input;
  using Output = typename TypeParam::Output;
  const ViewTable table = test::view_table(kCells, kKeys);
  ViewEntries entries(kCells);
  entries.set(table);
  for (const int channels : {1, 15, 16, 17, 48, 70}) {
    for (const float scale : {0.31F, 1.0F, 40.0F}) {
      const std::vector<Input> input = features<Input>(channels);
      std::vector<Output> bev(static_cast<size_t>(kCells * channels), Output{1});
      gather(entries, input, channels, scale, 0, 20, bev);
      gather(entries, input, channels, scale, 20, kCells, bev);
      EXPECT_EQ(bev, (scalar_twin<Input, Output>(table, input, channels, scale)))
          << channels << " channels, scale " << scale;
    }
  }
}

TYPED_TEST(ViewTransform, IsTheSameOnEveryCpu) {
  using Input = typename TypeParam::Input;
  using Output = typename TypeParam::Output;
  ViewEntries entries(kCells);
  entries.set(test::view_table(kCells, kKeys));
  for (const int channels : {1, 8, 17, 48, 100}) {
    const std::vector<Input> input = features<Input>(channels);
    const auto by = [&](Gather kernel) {
      std::vector<Output> bev(static_cast<size_t>(kCells * channels));
      kernel(entries, std::as_bytes(std::span(input)).data(), channels, 0.7F, 0, kCells,
             std::as_writable_bytes(std::span(bev)).data());
      return bev;
    };
    EXPECT_EQ(by(gather_for(type_of<Input>(), type_of<Output>())),
              by(gather_plain(type_of<Input>(), type_of<Output>())));
  }
}

TEST(ViewTransformCells, WithoutEntriesAreZero) {
  const ViewEntries nothing(kCells);
  const std::vector<uint8_t> input = features<uint8_t>(20);
  std::vector<uint8_t> bev(kCells * 20, 7);
  gather(nothing, input, 20, 1.0F, 0, kCells, bev);
  EXPECT_EQ(bev, std::vector<uint8_t>(kCells * 20, 0));
}

TEST(ViewTransformCells, OutsideTheRangeAreLeftAlone) {
  ViewEntries entries(kCells);
  entries.set(test::view_table(kCells, kKeys));
  const std::vector<uint8_t> input = features<uint8_t>(16);
  std::vector<uint8_t> bev(kCells * 16, 7);
  gather(entries, input, 16, 0.0F, 10, 11, bev);
  for (int i = 0; i < kCells * 16; ++i) EXPECT_EQ(bev[i], i / 16 == 10 ? 0 : 7);
}

}  // namespace
}  // namespace bevloc::nn
