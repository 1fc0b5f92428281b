// Eight floats or integers in NEON registers. Include it inside an anonymous namespace.

/// Loads fill the lanes from `count` on with 0, and stores leave the memory of these lanes
/// unchanged. Stores to 8-bit elements round to nearest even and saturate.
struct Lanes {
  static constexpr int kLanes = 8;
  struct Floats {
    float32x4_t low;
    float32x4_t high;
  };
  struct Integers {
    int32x4_t low;
    int32x4_t high;
  };

  static Integers load(const int32_t* from, int count) {
    if (count == kLanes) return {vld1q_s32(from), vld1q_s32(from + 4)};
    const auto lanes = filled(from, count);
    return {vld1q_s32(lanes.data()), vld1q_s32(lanes.data() + 4)};
  }
  static Floats load(const float* from, int count) {
    if (count == kLanes) return {vld1q_f32(from), vld1q_f32(from + 4)};
    const auto lanes = filled(from, count);
    return {vld1q_f32(lanes.data()), vld1q_f32(lanes.data() + 4)};
  }
  static Floats load_as_float(const float* from, int count) { return load(from, count); }
  static Floats load_as_float(const uint8_t* from, int count) {
    const uint8x8_t bytes = count == kLanes ? vld1_u8(from) : vld1_u8(filled(from, count).data());
    const uint16x8_t words = vmovl_u8(bytes);
    return {vcvtq_f32_u32(vmovl_u16(vget_low_u16(words))), vcvtq_f32_u32(vmovl_high_u16(words))};
  }
  static Floats load_as_float(const int8_t* from, int count) {
    const int8x8_t bytes = count == kLanes ? vld1_s8(from) : vld1_s8(filled(from, count).data());
    const int16x8_t words = vmovl_s8(bytes);
    return {vcvtq_f32_s32(vmovl_s16(vget_low_s16(words))), vcvtq_f32_s32(vmovl_high_s16(words))};
  }

  static Floats all(float value) { return {vdupq_n_f32(value), vdupq_n_f32(value)}; }
  static Floats sum(Floats a, Floats b) {
    return {vaddq_f32(a.low, b.low), vaddq_f32(a.high, b.high)};
  }
  static Floats product(Floats a, Floats b) {
    return {vmulq_f32(a.low, b.low), vmulq_f32(a.high, b.high)};
  }
  static Floats larger(Floats a, Floats b) {
    return {vmaxq_f32(a.low, b.low), vmaxq_f32(a.high, b.high)};
  }
  static Floats to_float(Integers lanes) {
    return {vcvtq_f32_s32(lanes.low), vcvtq_f32_s32(lanes.high)};
  }

  static void store(Floats lanes, float* to, int count) {
    std::array<float, kLanes> buffer;
    float* const whole = count == kLanes ? to : buffer.data();
    vst1q_f32(whole, lanes.low);
    vst1q_f32(whole + 4, lanes.high);
    if (count < kLanes) std::copy_n(buffer.data(), count, to);
  }
  static void store(Floats lanes, uint8_t* to, int count) {
    const uint8x8_t bytes = vqmovun_s16(rounded_to_words(lanes));
    if (count == kLanes) return vst1_u8(to, bytes);
    std::array<uint8_t, kLanes> buffer;
    vst1_u8(buffer.data(), bytes);
    std::copy_n(buffer.data(), count, to);
  }
  static void store(Floats lanes, int8_t* to, int count) {
    const int8x8_t bytes = vqmovn_s16(rounded_to_words(lanes));
    if (count == kLanes) return vst1_s8(to, bytes);
    std::array<int8_t, kLanes> buffer;
    vst1_s8(buffer.data(), bytes);
    std::copy_n(buffer.data(), count, to);
  }

 private:
  template <typename Element>
  static std::array<Element, kLanes> filled(const Element* from, int count) {
    std::array<Element, kLanes> lanes{};
    std::copy_n(from, count, lanes.data());
    return lanes;
  }
  static int16x8_t rounded_to_words(Floats lanes) {
    return vqmovn_high_s32(vqmovn_s32(vcvtnq_s32_f32(lanes.low)), vcvtnq_s32_f32(lanes.high));
  }
};
