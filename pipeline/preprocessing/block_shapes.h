// Parts of the block kernels that are the same for all instruction sets. Include it inside an
// anonymous namespace, after selecting the instruction set.

constexpr int kPixels = RemapBlocks::kPixels;

/// Prefetches the samples that the network pixels below a block will read. Camera frames come from
/// other cores and devices; without prefetching, a frame outside the near caches takes nearly twice
/// as long. `first` is the first sample of the block; a sample has `kSampleBytes`. The rows and
/// columns of the plane are those of the image divided by 2^kRowShift and 2^kColShift.
template <int kTaps, int kSampleBytes, int kRowShift = 0, int kColShift = 0>
[[gnu::always_inline]] inline void prefetch_below(const uint8_t* first,
                                                  std::ptrdiff_t stride_bytes) {
  constexpr int kCacheLine = 64;
  constexpr int kScale = kTaps - 1;  // approximate number of camera pixels per network pixel
  constexpr int kBytes = kPixels * kScale * kSampleBytes >> kColShift;
  constexpr int kBegin = kTaps >> kRowShift;
  constexpr int kEnd = (kTaps + kScale) >> kRowShift;
  for (int row = kBegin; row < kEnd; ++row) {
    for (int byte = 0; byte < kBytes; byte += kCacheLine) {
      __builtin_prefetch(first + row * stride_bytes + byte);
    }
  }
}

/// Calls `add` with the index of each part of a block in RemapBlocks. kParts is 1 or 4.
template <int kParts, typename Add>
[[gnu::always_inline]] inline void for_each_part(size_t block, const Add& add) {
  for (size_t part = 0; part < kParts; ++part) add(kParts * block + part);
}

template <int kTaps, int kParts>
struct PartShape {
  static constexpr int taps = kTaps;
  static constexpr int parts = kParts;
};

/// The kernel for boxes of `taps` pixels: calls `choose` with a PartShape. Returns null if there is
/// no kernel for this width.
template <typename Choose>
auto kernel_of_taps(int taps, const Choose& choose) -> decltype(choose(PartShape<2, 1>())) {
  switch (taps) {
    case 2:
      return choose(PartShape<2, 1>());
    case 3:
      return choose(PartShape<3, 1>());
    case 4:
      return choose(PartShape<4, 1>());
    case 5:
      return choose(PartShape<5, 1>());
    case 6:
      return choose(PartShape<6, 1>());
    case 7:
      return choose(PartShape<7, 1>());
    case 8:
      return choose(PartShape<4, 4>());
    case 9:
      return choose(PartShape<5, 4>());
    case 10:
    case 11:
    case 12:
      return choose(PartShape<6, 4>());
    case 13:
      return choose(PartShape<7, 4>());
    default:
      return nullptr;
  }
}

/// Calls `choose` with the reader of a YUV layout that has a kernel: Readers::Yuyv, Uyvy, Nv12,
/// I420 or I422. Returns null if no kernel reads the layout.
template <typename Readers, typename Choose>
BlockKernel<YuvLayout>* kernel_of_layout(const YuvLayout& layout, const Choose& choose) {
  if (layout.chroma_shift_x == 0) return nullptr;
  if (layout.y_step == 2) {
    const bool is_luma_first = layout.y.data < layout.u.data;
    return is_luma_first ? choose.template operator()<typename Readers::Yuyv>()
                         : choose.template operator()<typename Readers::Uyvy>();
  }
  if (layout.chroma_step == 2) return choose.template operator()<typename Readers::Nv12>();
  if (layout.chroma_shift_y == 1) return choose.template operator()<typename Readers::I420>();
  return choose.template operator()<typename Readers::I422>();
}

/// Samples of a Bayer row as their kernels order them. Columns of one parity fill 8 bytes. Where
/// four columns are enough, the 8 bytes contain them twice.
template <int kTaps>
constexpr int kBayerColumns = kTaps <= 5 ? 4 : 8;

/// Column of byte i, counted from the first loaded column. Loading starts one column to the left of
/// a block's first column, which is even, so that 16 bytes contain odd columns of the frame in the
/// lower half and even ones in the upper half.
template <int kTaps>
constexpr int bayer_column(int i) {
  return 2 * (i % kBayerColumns<kTaps>)+i / 8;
}
