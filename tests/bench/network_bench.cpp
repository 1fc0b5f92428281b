// Latency of the network's parts.
//
//   bench_network MODEL.onnx [Google Benchmark's options]
//
// MODEL is a shipped one, or one with random weights:
//   tests/pipeline/network/make_fixtures.py --nano MODEL.onnx
#include <cstdlib>
#include <memory>
#include <string>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "pipeline/network/network.h"

namespace bevloc {
namespace {

std::string model_path;

/// One network for each number of threads, made when it is first asked for.
Network& network(int threads) {
  static std::unique_ptr<Network> networks[8];
  std::unique_ptr<Network>& network = networks[threads];
  if (network == nullptr) {
    auto loaded = Network::load(model_path, {.threads = threads});
    if (!loaded) {
      fmt::print(stderr, "{}\n", loaded.error().message);
      std::exit(1);
    }
    network = std::move(*loaded);
    ViewTable table;
    const int cells = kFeatureGrid.cells();
    for (int i = 0; i < kViewSlots * cells; ++i) {
      table.index.push_back(i % (kCameraCount * kImageFeatureCells));
      table.weight.push_back(i < 6 * cells ? 1.0F / 6.0F : 0.0F);
    }
    network->set_view_table(table);
    for (int8_t& pixel : network->image_input()) pixel = static_cast<int8_t>(std::rand());
    for (uint8_t& cell : network->raster_input()) cell = static_cast<uint8_t>(std::rand());
  }
  return *network;
}

template <void (Network::*kRun)()>
void run_part(benchmark::State& state) {
  Network& part = network(static_cast<int>(state.range(0)));
  for (auto _ : state) (part.*kRun)();
}

BENCHMARK(run_part<&Network::run_image_branch>)->Name("images")->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(run_part<&Network::run_map_branch>)->Name("map")->Arg(1)->Arg(2)->UseRealTime();
BENCHMARK(run_part<&Network::run_mask_head>)->Name("mask")->Arg(1)->Arg(2)->UseRealTime();

}  // namespace
}  // namespace bevloc

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (argc != 2) {
    fmt::print(stderr, "usage: {} MODEL.onnx [benchmark options]\n", argv[0]);
    return 2;
  }
  bevloc::model_path = argv[1];
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
