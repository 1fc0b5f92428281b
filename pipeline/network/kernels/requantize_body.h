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
#pragma GCC unroll 2
  for (int v = 0; v < kVectors; ++v) {
    scales[v] = Lanes::load(r.scale.data() + channel + v * Lanes::kLanes, count);
  }
  const auto residual_scale = Lanes::all(r.residual_scale);
  // Saturating to the range of an unsigned type already removes negative values.
  const bool is_cut = r.relu && !std::is_unsigned_v<Output>;
  const auto* residual = reinterpret_cast<const Residual*>(row.residual) + channel;
  auto* output = reinterpret_cast<Output*>(row.output) + channel;
  const int32_t* sums = row.sums + channel;
  for (int p = 0; p < row.pixels; ++p) {
#pragma GCC unroll 2
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
    if constexpr (!std::is_same_v<Residual, NoResidual>) residual += r.channels;
    sums += row.sums_step;
    output += r.channels;
  }
}

template <typename Output, typename Residual>
void requantize(const Requantizer& r, const RequantizedRow& row) {
  int c = 0;
  for (; c + 2 * Lanes::kLanes <= r.channels; c += 2 * Lanes::kLanes) {
    requantize_lanes<2, Output, Residual>(r, row, c, Lanes::kLanes);
  }
  if (c + Lanes::kLanes <= r.channels) {
    requantize_lanes<1, Output, Residual>(r, row, c, Lanes::kLanes);
    c += Lanes::kLanes;
  }
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
