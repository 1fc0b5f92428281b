#include "training/native/runtime.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "pipeline/network/network.h"
#include "pipeline/solver/solver_factory.h"

namespace {

constexpr int kImageOffset = 128;

void report(const std::string& message, char* error, int error_size) {
  const size_t length = std::min(message.size(), static_cast<size_t>(error_size) - 1);
  *std::copy_n(message.begin(), length, error) = '\0';
}

}  // namespace

struct bevloc_network {
  std::unique_ptr<bevloc::Network> network;
};

struct bevloc_solver {
  std::unique_ptr<bevloc::Solver> solver;
  bevloc::SolverResult result;
};

bevloc_network* bevloc_network_create(const char* model, int threads, char* error, int error_size) {
  auto network = bevloc::Network::load(model, {.threads = threads});
  if (network) return new bevloc_network{std::move(*network)};
  report(network.error().message, error, error_size);
  return nullptr;
}

void bevloc_network_destroy(bevloc_network* network) {
  delete network;
}

void bevloc_network_run(bevloc_network* network, const uint8_t* images, const int32_t* index,
                        const float* weight, const uint8_t* raster, float* bev, float* map,
                        float* mask) {
  bevloc::Network& net = *network->network;
  const size_t entries = static_cast<size_t>(bevloc::kViewSlots) * bevloc::kFeatureGrid.cells();
  net.set_view_table({.index = {index, index + entries}, .weight = {weight, weight + entries}});
  const std::span<int8_t> image_input = net.image_input();
  std::transform(images, images + image_input.size(), image_input.begin(),
                 [](uint8_t value) { return static_cast<int8_t>(value - kImageOffset); });
  std::copy_n(raster, net.raster_input().size(), net.raster_input().begin());
  net.run_image_branch();
  net.run_map_branch();
  net.run_mask_head();
  std::ranges::copy(net.bev_features().data, bev);
  std::ranges::copy(net.map_features().data, map);
  std::ranges::copy(net.mask_logits(), mask);
}

bevloc_solver* bevloc_solver_create(const bevloc_network* network, const char* kind, char* error,
                                    int error_size) {
  const auto make = [&](bevloc::SolverKind solver_kind) {
    return bevloc::make_solver(solver_kind, bevloc::kFeatureGrid, bevloc::kFeatureChannels,
                               bevloc::HypothesisGrid{}, network->network->solver_parameters());
  };
  auto solver = bevloc::solver_kind_from(kind).and_then(make);
  if (solver) return new bevloc_solver{std::move(*solver), {}};
  report(solver.error().message, error, error_size);
  return nullptr;
}

void bevloc_solver_destroy(bevloc_solver* solver) {
  delete solver;
}

void bevloc_solver_solve(bevloc_solver* solver, const float* bev, const float* map,
                         float* correction, float* deviation, float* probabilities, float* score) {
  const auto view = [](const float* data) {
    const size_t size =
        static_cast<size_t>(bevloc::kFeatureChannels) * bevloc::kFeatureGrid.cells();
    return bevloc::FeatureView{{data, size}, bevloc::kFeatureChannels, bevloc::kFeatureGrid};
  };
  bevloc::SolverResult& result = solver->result;
  solver->solver->solve(view(bev), view(map), result);
  const bevloc::Se2& found = result.correction;
  std::ranges::transform(std::initializer_list<double>{found.x_m, found.y_m, found.yaw_rad},
                         correction, [](double value) { return static_cast<float>(value); });
  for (int axis = 0; axis < 3; ++axis) {
    deviation[axis] = static_cast<float>(std::sqrt(result.covariance(axis, axis)));
  }
  for (const auto* probability :
       {&result.x_probability, &result.y_probability, &result.yaw_probability}) {
    probabilities = std::ranges::copy(*probability, probabilities).out;
  }
  *score = static_cast<float>(result.score);
}
