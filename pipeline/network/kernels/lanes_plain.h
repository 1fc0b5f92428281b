// The same operations as lanes_avx2.h in plain C++: eight floats or integers in arrays. Include it
// inside an anonymous namespace.

/// Loads fill the lanes from `count` on with 0, and stores leave the memory of these lanes
/// unchanged. Stores to 8-bit elements round to nearest even and saturate.
struct Lanes {
  static constexpr int kLanes = 8;
  template <typename Element>
  using Array = std::array<Element, kLanes>;
  using Floats = Array<float>;

  template <typename Element>
  static Array<Element> load(const Element* from, int count) {
    Array<Element> lanes{};
    std::copy_n(from, count, lanes.begin());
    return lanes;
  }
  template <typename Element>
  static Floats load_as_float(const Element* from, int count) {
    Floats lanes{};
    std::copy_n(from, count, lanes.begin());
    return lanes;
  }

  static Floats all(float value) {
    Floats lanes{};
    lanes.fill(value);
    return lanes;
  }
  static Floats sum(Floats a, const Floats& b) {
    for (int i = 0; i < kLanes; ++i) a[i] += b[i];
    return a;
  }
  static Floats product(Floats a, const Floats& b) {
    for (int i = 0; i < kLanes; ++i) a[i] *= b[i];
    return a;
  }
  static Floats larger(Floats a, const Floats& b) {
    for (int i = 0; i < kLanes; ++i) a[i] = std::max(a[i], b[i]);
    return a;
  }
  static Floats to_float(const Array<int32_t>& integers) {
    Floats lanes{};
    std::ranges::transform(integers, lanes.begin(),
                           [](int32_t i) { return static_cast<float>(i); });
    return lanes;
  }

  static void store(const Floats& lanes, float* to, int count) {
    std::copy_n(lanes.begin(), count, to);
  }
  template <typename Output>
  static void store(const Floats& lanes, Output* to, int count) {
    // Adding and subtracting 1.5 * 2^23 rounds a small float to the nearest even integer.
    constexpr float kRounder = 12582912.0F;
    constexpr float kLowest = std::numeric_limits<Output>::min();
    constexpr float kHighest = std::numeric_limits<Output>::max();
    for (int i = 0; i < count; ++i) {
      to[i] = static_cast<Output>((std::clamp(lanes[i], kLowest, kHighest) + kRounder) - kRounder);
    }
  }
};
