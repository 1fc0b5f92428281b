#include "pipeline/network/network.h"

#include <algorithm>

#include <fmt/ranges.h>

#include "common/number_text.h"
#include "pipeline/network/model/load_error.h"
#include "pipeline/network/model/lowering.h"
#include "pipeline/network/model/onnx_reader.h"
#include "pipeline/network/test_frame.h"
#include "pipeline/preprocessing/network_camera.h"

namespace bevloc {
namespace {

using nn::ElementType;
using nn::Shape;

constexpr const char* kImages = "images";
constexpr const char* kRaster = "raster";
constexpr const char* kBevFeatures = "bev_features";
constexpr const char* kMapFeatures = "map_features";
constexpr const char* kBevMask = "bev_mask";

/// Indices of the branches, in the order in which the engine is given them.
enum BranchIndex : size_t { kImageBranch, kMapBranch, kMaskBranch };

/// The name of a port with the element types and shapes that it may have.
struct Contract {
  std::string name;
  std::vector<ElementType> types;
  std::vector<Shape> shapes;
};

std::vector<Contract> input_contracts() {
  const Shape table{kViewSlots, kFeatureGrid.cells()};
  const Shape raster{kRasterChannels, kRasterGrid.rows, kRasterGrid.cols};
  return {{kImages, {ElementType::kInt8}, {{kCameraCount, 3, kNetworkHeightPx, kNetworkWidthPx}}},
          {nn::kViewIndexPort, {ElementType::kInt32, ElementType::kInt64}, {table}},
          {nn::kViewWeightPort, {ElementType::kFloat32}, {table}},
          {kRaster, {ElementType::kUint8}, {raster, {1, raster[0], raster[1], raster[2]}}}};
}

std::vector<Contract> output_contracts() {
  const Shape features{1, kFeatureChannels, kFeatureGrid.rows, kFeatureGrid.cols};
  const Shape mask{1, kRasterChannels, kRasterGrid.rows, kRasterGrid.cols};
  return {{kBevFeatures, {ElementType::kFloat32}, {features}},
          {kMapFeatures, {ElementType::kFloat32}, {features}},
          {kBevMask, {ElementType::kFloat32}, {mask}}};
}

std::string names_of(const std::vector<nn::Port>& ports) {
  std::vector<std::string_view> names;
  for (const nn::Port& port : ports) names.push_back(port.name);
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

void check_ports(const std::vector<nn::Port>& ports, const std::vector<Contract>& contracts,
                 const char* kind) {
  for (const Contract& contract : contracts) {
    const auto port = std::ranges::find(ports, contract.name, &nn::Port::name);
    if (port == ports.end()) {
      nn::refuse("there is no {} '{}' (found: {})", kind, contract.name, names_of(ports));
    }
    const bool fits = std::ranges::count(contract.types, port->type) > 0 &&
                      std::ranges::count(contract.shapes, port->shape) > 0;
    if (!fits) {
      nn::refuse("{} '{}' is {} {}, wanted {} {}", kind, port->name, nn::name_of(port->type),
                 nn::to_string(port->shape), nn::name_of(contract.types[0]),
                 nn::to_string(contract.shapes[0]));
    }
  }
  if (ports.size() != contracts.size()) {
    nn::refuse("found {} {}s ({}), wanted {}", ports.size(), kind, names_of(ports),
               contracts.size());
  }
}

struct Bounds {
  float least;
  float most;
};
/// Trained parameters lie far inside of these bounds.
constexpr Bounds kParameterBounds{0.01F, 1e6F};
/// Factors by which the evaluation corrects sigma and score. They are near 1: any match would pass
/// the limits of the score if it were a thousand times too large.
constexpr Bounds kCorrectionBounds{0.1F, 10.0F};

float parameter(const nn::Graph& graph, const std::string& key, const Bounds& bounds) {
  const auto entry = graph.metadata.find(key);
  if (entry == graph.metadata.end()) nn::refuse("metadata '{}' is missing", key);
  const std::string& text = entry->second;
  const auto number = parse_number<float>(text);
  if (!(number >= bounds.least && number <= bounds.most)) {
    nn::refuse("metadata '{}' is '{}', wanted a number of {} to {}", key, text, bounds.least,
               bounds.most);
  }
  return *number;
}

std::string metadata_or_empty(const nn::Graph& graph, const std::string& key) {
  const auto entry = graph.metadata.find(key);
  return entry == graph.metadata.end() ? std::string() : entry->second;
}

float parameter_or(const nn::Graph& graph, const std::string& key, float fallback,
                   const Bounds& bounds) {
  return graph.metadata.contains(key) ? parameter(graph, key, bounds) : fallback;
}

SolverParameters read_solver_parameters(const nn::Graph& graph) {
  SolverParameters parameters;
  parameters.joint_scale = parameter(graph, "bevloc.solver.joint_scale", kParameterBounds);
  parameters.x_scale = parameter(graph, "bevloc.solver.x_scale", kParameterBounds);
  parameters.y_scale = parameter(graph, "bevloc.solver.y_scale", kParameterBounds);
  parameters.yaw_scale = parameter(graph, "bevloc.solver.yaw_scale", kParameterBounds);
  parameters.gem_omega = parameter(graph, "bevloc.solver.gem_omega", kParameterBounds);
  const float joint = parameters.joint_scale;
  for (const auto& [name, value] : {std::pair("refine_x_scale", &parameters.refine_x_scale),
                                    std::pair("refine_y_scale", &parameters.refine_y_scale),
                                    std::pair("refine_yaw_scale", &parameters.refine_yaw_scale),
                                    std::pair("banded_x_scale", &parameters.banded_x_scale),
                                    std::pair("banded_y_scale", &parameters.banded_y_scale)}) {
    *value = parameter_or(graph, std::string("bevloc.solver.") + name, joint, kParameterBounds);
  }
  parameters.sigma_scale =
      parameter_or(graph, "bevloc.solver.sigma_scale", 1.0F, kCorrectionBounds);
  parameters.score_scale =
      parameter_or(graph, "bevloc.solver.score_scale", 1.0F, kCorrectionBounds);
  return parameters;
}

/// The image branch must not depend on the raster, nor the map branch on the images.
void check_independence(const nn::Program& program, const char* output, const char* input) {
  const auto port = std::ranges::find(program.inputs, input, &nn::ProgramPort::name);
  if (nn::needed_values(program, output)[static_cast<size_t>(port->value)]) {
    nn::refuse("output '{}' depends on input '{}', wanted separate branches", output, input);
  }
}

/// The view table's indices count the features of all cameras, so the features of the model must
/// have exactly this number and size.
void check_view_features(const nn::Program& program) {
  for (const nn::Step& step : program.steps) {
    const auto* view = std::get_if<nn::ViewStep>(&step);
    if (view == nullptr) continue;
    const auto& dims = program.values[static_cast<size_t>(view->input)].dims;
    if (dims[0] != kCameraCount || dims[2] != kImageFeatureRows || dims[3] != kImageFeatureCols) {
      nn::refuse("the view transform reads features {}, wanted [{}, channels, {}, {}]",
                 nn::to_string({dims.begin(), dims.end()}), kCameraCount, kImageFeatureRows,
                 kImageFeatureCols);
    }
  }
}

}  // namespace

struct Network::State {
  State(const nn::Graph& graph, const nn::Program& program, const NetworkOptions& options)
      : name(graph.name),
        stored_answer(metadata_or_empty(graph, std::string(kAnswerKey))),
        solver_parameters(read_solver_parameters(graph)),
        rig(read_model_rig(graph)),
        engine(program, std::vector<nn::Branch>{{kBevFeatures}, {kMapFeatures}, {kBevMask}},
               kFeatureGrid.cells(), options) {}

  FeatureView features(const char* output) const {
    return {engine.output(output), kFeatureChannels, kFeatureGrid};
  }

  std::string name;
  std::string stored_answer;
  SolverParameters solver_parameters;
  ModelRig rig;
  nn::Engine engine;
};

Network::Network(std::unique_ptr<State> state) : state_(std::move(state)) {}
Network::~Network() = default;

Result<std::unique_ptr<Network>> Network::load(const std::string& path,
                                               const NetworkOptions& options) {
  if (options.threads < 1) return fail("network: {} threads, wanted at least 1", options.threads);
  return nn::loaded(path, [&]() -> Result<std::unique_ptr<Network>> {
    const nn::Graph graph = nn::read_onnx(path);
    check_ports(graph.inputs, input_contracts(), "input");
    check_ports(graph.outputs, output_contracts(), "output");
    const nn::Program program = nn::lower(graph);
    check_independence(program, kBevFeatures, kRaster);
    check_independence(program, kMapFeatures, kImages);
    check_view_features(program);
    auto state = std::make_unique<State>(graph, program, options);
    return std::unique_ptr<Network>(new Network(std::move(state)));
  });
}

void Network::set_view_table(const ViewTable& table) {
  state_->engine.set_view_table(table);
}

std::span<int8_t> Network::image_input() {
  const std::span<std::byte> bytes = state_->engine.input(kImages);
  return {reinterpret_cast<int8_t*>(bytes.data()), bytes.size()};
}

std::span<uint8_t> Network::raster_input() {
  const std::span<std::byte> bytes = state_->engine.input(kRaster);
  return {reinterpret_cast<uint8_t*>(bytes.data()), bytes.size()};
}

void Network::run_image_branch() {
  state_->engine.run(kImageBranch);
}
void Network::run_map_branch() {
  state_->engine.run(kMapBranch);
}
void Network::run_mask_head() {
  state_->engine.run(kMaskBranch);
}

void Network::parallel_for(int count, LoopBody body) {
  state_->engine.parallel_for(count, body);
}

FeatureView Network::bev_features() const {
  return state_->features(kBevFeatures);
}
FeatureView Network::map_features() const {
  return state_->features(kMapFeatures);
}
std::span<const float> Network::mask_logits() const {
  return state_->engine.output(kBevMask);
}

const SolverParameters& Network::solver_parameters() const {
  return state_->solver_parameters;
}
const ModelRig& Network::rig() const {
  return state_->rig;
}
const std::string& Network::name() const {
  return state_->name;
}
const std::string& Network::stored_answer() const {
  return state_->stored_answer;
}

}  // namespace bevloc
