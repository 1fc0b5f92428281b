// Requantizes one row of pixels. The source file of each instruction set includes it inside an
// anonymous namespace, after selecting that set and defining a struct `Lanes` with operations on
// eight floats or integers.

/// Stands for the residual's element type where there is no residual.
struct NoResidual {};

/// Requantizes the channels from `channel` on of all pixels, in kVectors registers. Each register
/// holds `count` channels, at most kLanes.
template <int kVectors, typename Output, typename Residual>
[[gnu::always_inline]] inline void requantize_lanes(const Requantizer& r, const RequantizedRow& row,
                                                    int channel, int count) {
  decltype(Lanes::all(0.0F)) scales[kVectors];
#pragma GCC unroll 3
  for (int v = 0; v < kVectors; ++v) {
    scales[v] = Lanes::load(r.scale.data() + channel + v * Lanes::kLanes, count);
  }
  const auto residual_scale = Lanes::all(r.residual_scale);
  // Local, because the compiler must assume that writing the output changes `r` and `row`.
  const int channels = r.channels;
  const int pixels = row.pixels;
  const std::ptrdiff_t sums_step = row.sums_step;
  // Saturating to the range of an unsigned type already removes negative values.
  const bool is_cut = r.relu && !std::is_unsigned_v<Output>;
  const auto* residual = reinterpret_cast<const Residual*>(row.residual) + channel;
  auto* output = reinterpret_cast<Output*>(row.output) + channel;
  const int32_t* sums = row.sums + channel;
#pragma GCC unroll 2
  for (int p = 0; p < pixels; ++p) {
#pragma GCC unroll 3
    for (int v = 0; v < kVectors; ++v) {
      const int first = v * Lanes::kLanes;
      auto real =
          Lanes::product(Lanes::to_float(Lanes::load(sums + first, Lanes::kLanes)), scales[v]);
      if constexpr (!std::is_same_v<Residual, NoResidual>) {
        const auto old = Lanes::load_as_float(residual + first, count);
        real = Lanes::sum(real, Lanes::product(old, residual_scale));
      }
      if (is_cut) real = Lanes::larger(real, Lanes::all(0.0F));
      Lanes::store(real, output + first, count);
    }
    if constexpr (!std::is_same_v<Residual, NoResidual>) residual += channels;
    sums += sums_step;
    output += channels;
  }
}

template <typename Output, typename Residual>
void requantize(const Requantizer& r, const RequantizedRow& row) {
  int c = 0;
  const auto requantize_whole = [&]<int kVectors>() {
    requantize_lanes<kVectors, Output, Residual>(r, row, c, Lanes::kLanes);
    c += kVectors * Lanes::kLanes;
  };
  const int vectors = r.channels / Lanes::kLanes;
  if (vectors % 2 == 1 && vectors > 1) requantize_whole.template operator()<3>();
  while (c + 2 * Lanes::kLanes <= r.channels) requantize_whole.template operator()<2>();
  if (vectors == 1) requantize_whole.template operator()<1>();
  constexpr int kHalf = Lanes::kLanes / 2;
  const int left = r.channels - c;
  if (left == kHalf) {
    requantize_lanes<1, Output, Residual>(r, row, c, kHalf);
  } else if (left > 0) {
    requantize_lanes<1, Output, Residual>(r, row, c, left);
  }
}

template <typename Output>
Requantize requantize_to(ElementType residual, bool has_residual) {
  if (!has_residual) return requantize<Output, NoResidual>;
  if (residual == ElementType::kUint8) return requantize<Output, uint8_t>;
  if (residual == ElementType::kInt8) return requantize<Output, int8_t>;
  return requantize<Output, float>;
}

Requantize requantize_by_type(ElementType output, ElementType residual, bool has_residual) {
  if (output == ElementType::kUint8) return requantize_to<uint8_t>(residual, has_residual);
  if (output == ElementType::kInt8) return requantize_to<int8_t>(residual, has_residual);
  return requantize_to<float>(residual, has_residual);
}
