// Computes the weighted sums of one BEV cell after the other. The source file of each instruction
// set includes it inside an anonymous namespace, after selecting that set and defining a struct
// `Lanes` with operations on eight floats.

/// Computes the channels from `first` on of one cell, with the sums in kVectors registers. Each
/// register holds `count` channels.
template <int kVectors, typename Input, typename Output>
[[gnu::always_inline]] inline void gather_channels(const ViewEntries& entries,
                                                   const Input* features, int channels, int cell,
                                                   float scale, int first, int count, Output* bev) {
  decltype(Lanes::all(0.0F)) sums[kVectors];
#pragma GCC unroll 8
  for (int v = 0; v < kVectors; ++v) sums[v] = Lanes::all(0.0F);
  const int32_t last = entries.first()[cell + 1];
  for (int32_t entry = entries.first()[cell]; entry < last; ++entry) {
    const Input* const feature =
        features + static_cast<size_t>(entries.index()[entry]) * channels + first;
    const auto weight = Lanes::all(entries.weight()[entry]);
#pragma GCC unroll 8
    for (int v = 0; v < kVectors; ++v) {
      const auto seen = Lanes::load_as_float(feature + v * Lanes::kLanes, count);
      sums[v] = Lanes::sum(sums[v], Lanes::product(weight, seen));
    }
  }
  Output* const output = bev + static_cast<size_t>(cell) * channels + first;
#pragma GCC unroll 8
  for (int v = 0; v < kVectors; ++v) {
    Lanes::store(Lanes::product(sums[v], Lanes::all(scale)), output + v * Lanes::kLanes, count);
  }
}

template <typename Input, typename Output>
void gather(const ViewEntries& entries, const std::byte* features, int channels, float scale,
            int begin, int end, std::byte* bev) {
  constexpr int kMany = 6;  // vectors of sums that fit into registers
  const auto* from = reinterpret_cast<const Input*>(features);
  auto* to = reinterpret_cast<Output*>(bev);
  for (int cell = begin; cell < end; ++cell) {
    int c = 0;
    for (; c + kMany * Lanes::kLanes <= channels; c += kMany * Lanes::kLanes) {
      gather_channels<kMany>(entries, from, channels, cell, scale, c, Lanes::kLanes, to);
    }
    for (; c + Lanes::kLanes <= channels; c += Lanes::kLanes) {
      gather_channels<1>(entries, from, channels, cell, scale, c, Lanes::kLanes, to);
    }
    if (c < channels) {
      gather_channels<1>(entries, from, channels, cell, scale, c, channels - c, to);
    }
  }
}

template <typename Input>
Gather gather_from(ElementType output) {
  if (output == ElementType::kUint8) return gather<Input, uint8_t>;
  if (output == ElementType::kInt8) return gather<Input, int8_t>;
  return gather<Input, float>;
}

Gather gather_by_type(ElementType input, ElementType output) {
  if (input == ElementType::kUint8) return gather_from<uint8_t>(output);
  if (input == ElementType::kInt8) return gather_from<int8_t>(output);
  return gather_from<float>(output);
}
