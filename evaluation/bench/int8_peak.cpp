#include "evaluation/bench/int8_peak.h"

#include <cstring>
#include <unordered_map>

#include <dnnl.hpp>
#include <omp.h>

#include "evaluation/bench/strip_peak.h"
#include "pipeline/network/engine/isa.h"
#include "pipeline/network/kernels/strip_kernels.h"

namespace bevloc::bench {
namespace {

using dnnl::memory;

#ifdef __aarch64__
constexpr bool kOneDnnIsFast = false;
#else
constexpr bool kOneDnnIsFast = true;
#endif

/// Memory filled with ones.
memory filled(const memory::desc& desc, const dnnl::engine& engine) {
  memory made(desc, engine);
  std::memset(made.get_data_handle(), 1, desc.get_size());
  return made;
}

memory::desc any_layout(const memory::dims& dims, memory::data_type type) {
  return {dims, type, memory::format_tag::any};
}

// Version 3 of oneDNN has no descriptions of operations besides those of primitives.

dnnl::convolution_forward::primitive_desc convolution_of(const memory::desc& map,
                                                         const memory::desc& weights,
                                                         const dnnl::engine& engine) {
  constexpr auto kKind = dnnl::prop_kind::forward_inference;
  constexpr auto kAlgorithm = dnnl::algorithm::convolution_direct;
  const memory::dims ones{1, 1};
#if DNNL_VERSION_MAJOR >= 3
  return {engine, kKind, kAlgorithm, map, weights, map, ones, ones, ones};
#else
  return {{kKind, kAlgorithm, map, weights, map, ones, ones, ones}, engine};
#endif
}

dnnl::matmul::primitive_desc product_of(const memory::desc& left, const memory::desc& right,
                                        const memory::desc& result, const dnnl::engine& engine) {
#if DNNL_VERSION_MAJOR >= 3
  return {engine, left, right, result};
#else
  return {{left, right, result}, engine};
#endif
}

template <typename Primitive>
double seconds_per_run(const typename Primitive::primitive_desc& description,
                       const dnnl::engine& engine, const TimeOfRun& time_s) {
  const Primitive primitive(description);
  const std::unordered_map<int, memory> arguments{
      {DNNL_ARG_SRC, filled(description.src_desc(), engine)},
      {DNNL_ARG_WEIGHTS, filled(description.weights_desc(), engine)},
      {DNNL_ARG_DST, filled(description.dst_desc(), engine)}};
  dnnl::stream stream(engine);
  return time_s([&] {
    primitive.execute(stream, arguments);
    stream.wait();
  });
}

double convolution_macs_per_s(const dnnl::engine& engine, const TimeOfRun& time_s) {
  constexpr memory::dim kImages = 6;
  constexpr memory::dim kChannels = 256;
  constexpr memory::dim kRows = 32;
  constexpr memory::dim kCols = 56;
  constexpr memory::dim kSide = 3;
  const memory::dims map{kImages, kChannels, kRows, kCols};
  const auto description = convolution_of(
      any_layout(map, memory::data_type::u8),
      any_layout({kChannels, kChannels, kSide, kSide}, memory::data_type::s8), engine);
  const double seconds = seconds_per_run<dnnl::convolution_forward>(description, engine, time_s);
  return static_cast<double>(kImages * kRows * kCols * kChannels * kChannels * kSide * kSide) /
         seconds;
}

double matmul_macs_per_s(const dnnl::engine& engine, const TimeOfRun& time_s) {
  constexpr memory::dim kSize = 1024;
  const memory::dims square{kSize, kSize};
  const auto description = product_of(any_layout(square, memory::data_type::u8),
                                      any_layout(square, memory::data_type::s8),
                                      any_layout(square, memory::data_type::s32), engine);
  const double seconds = seconds_per_run<dnnl::matmul>(description, engine, time_s);
  return static_cast<double>(kSize * kSize * kSize) / seconds;
}

Int8Peak measure_onednn(int threads, const TimeOfRun& time_s) {
  nn::onednn::cap_cpu_isa(IsaCap::kBest);
  omp_set_num_threads(threads);  // oneDNN makes its kernels for this number
  const dnnl::engine engine(dnnl::engine::kind::cpu, 0);
  return {convolution_macs_per_s(engine, time_s), matmul_macs_per_s(engine, time_s)};
}

std::string onednn_instruction_set() {
  switch (dnnl::get_effective_cpu_isa()) {
    case dnnl::cpu_isa::avx2:
      return "avx2";
    case dnnl::cpu_isa::avx2_vnni:
      return "avx2_vnni";
    case dnnl::cpu_isa::avx512_core:
      return "avx512_core";
    case dnnl::cpu_isa::avx512_core_vnni:
      return "avx512_core_vnni";
    case dnnl::cpu_isa::avx512_core_bf16:
      return "avx512_core_bf16";
    case dnnl::cpu_isa::avx512_core_amx:
      return "avx512_core_amx";
    default:
      return "other";
  }
}

}  // namespace

Int8Peak measure_int8_peak(int threads, const TimeOfRun& time_s) {
  if constexpr (kOneDnnIsFast) {
    return measure_onednn(threads, time_s);
  } else {
    return {strip_macs_per_s(threads, time_s), 0.0};
  }
}

std::string instruction_set() {
  return kOneDnnIsFast ? onednn_instruction_set() : nn::kernel_sets().front()->name;
}

}  // namespace bevloc::bench
