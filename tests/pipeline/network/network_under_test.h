// Loads and runs whole networks on the engine under test (engine/engine_under_test.h).
#pragma once

#include <cstdlib>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "pipeline/network/network.h"
#include "tests/pipeline/network/engine/engine_under_test.h"
#include "tests/pipeline/network/model_inputs.h"

namespace bevloc::test {

inline constexpr const char* kShippedModel = BEVLOC_SOURCE_DIR "/models/nano.onnx";

inline NetworkOptions network_options(int threads = 1) {
  const EngineUnderTest& tested = engine_under_test();
  return {.threads = threads, .isa = tested.isa, .own_kernels = tested.own_kernels};
}

/// Loads a network from the folder fixtures/ and sets its inputs. The expected outputs in that
/// folder were computed by numpy from the same inputs. Ends the program if the network does not
/// load.
inline std::unique_ptr<Network> load_network(const std::string& model, int threads = 1) {
  auto network = Network::load(fixture(model + ".onnx"), network_options(threads));
  if (!network) {
    ADD_FAILURE() << network.error().message;
    std::abort();
  }
  (*network)->set_view_table(network_view_table());
  fill_input((*network)->image_input(), 1);
  fill_input((*network)->raster_input(), 2);
  return std::move(*network);
}

/// Loads the shipped network. If that fails, the test fails, and the result is null.
inline std::unique_ptr<Network> load_shipped() {
  auto network = Network::load(kShippedModel, network_options());
  if (!network) ADD_FAILURE() << network.error().message;
  return network ? std::move(*network) : nullptr;
}

inline void run_all(Network& network) {
  network.run_image_branch();
  network.run_map_branch();
  network.run_mask_head();
}

}  // namespace bevloc::test
