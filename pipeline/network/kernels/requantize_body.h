// Requantizes one row of pixels. The source file of each instruction set includes it inside an
// anonymous namespace, after selecting that set and defining a struct `Lanes` with operations on
// eight floats or integers.

/// Stands for the residual's element type where there is no residual.
struct NoResidual {};

/// Requantizes the channels [channel, channel + count) of all pixels. `count` is at most kLanes.
template <typename Output, typename Residual>
[[gnu::always_inline]] inline void requantize_lanes(const Requantizer& r, const RequantizedRow& row,
                                                    int channel, int count) {
  const auto scale = Lanes::load(r.scale.data() + channel, count);
  const auto residual_scale = Lanes::all(r.residual_scale);
  // Saturating to the range of an unsigned type already removes negative values.
  const bool is_cut = r.relu && !std::is_unsigned_v<Output>;
  const auto* residual = reinterpret_cast<const Residual*>(row.residual) + channel;
  auto* output = reinterpret_cast<Output*>(row.output) + channel;
  const int32_t* sums = row.sums + channel;
  for (int p = 0; p < row.pixels; ++p) {
    auto real = Lanes::product(Lanes::to_float(Lanes::load(sums, Lanes::kLanes)), scale);
    if constexpr (!std::is_same_v<Residual, NoResidual>) {
      const auto old = Lanes::load_as_float(residual, count);
      real = Lanes::sum(real, Lanes::product(old, residual_scale));
      residual += r.channels;
    }
    if (is_cut) real = Lanes::larger(real, Lanes::all(0.0F));
    Lanes::store(real, output, count);
    sums += row.sums_step;
    output += r.channels;
  }
}

template <typename Output, typename Residual>
void requantize(const Requantizer& r, const RequantizedRow& row) {
  const int whole = r.channels / Lanes::kLanes * Lanes::kLanes;
  for (int c = 0; c < whole; c += Lanes::kLanes) {
    requantize_lanes<Output, Residual>(r, row, c, Lanes::kLanes);
  }
  constexpr int kHalf = Lanes::kLanes / 2;
  const int left = r.channels - whole;
  if (left == kHalf) {
    requantize_lanes<Output, Residual>(r, row, whole, kHalf);
  } else if (left > 0) {
    requantize_lanes<Output, Residual>(r, row, whole, left);
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
