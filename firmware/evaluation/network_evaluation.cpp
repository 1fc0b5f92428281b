#include "firmware/evaluation/network_evaluation.h"

#include <algorithm>

#include "pipeline/map/rasterizer.h"
#include "pipeline/preprocessing/image_remap.h"
#include "pipeline/solver/posterior.h"
#include "sim/perception/matching_scene.h"

namespace bevloc::evaluation {
namespace {

static_assert(sim::kEvaluationSampleSeedBase + sim::kSampleSeedCount <= sim::kTuningSeedBase);
static_assert(kFramesPerWorld <= sim::kSamplesPerWorld);

constexpr std::array<SolverKind, 5> kSolvers{SolverKind::kFullFft, SolverKind::kBlock,
                                             SolverKind::kDecoupled, SolverKind::kDecoupledRefined,
                                             SolverKind::kBandedRefined};
const HypothesisGrid kHypotheses;

/// A cell of a raster belongs to a line that covers more than half of it.
constexpr uint8_t kHalfCovered = 127;

std::vector<ReadOut> empty_read_outs() {
  std::vector<ReadOut> read_outs{{"prior", {}}};
  for (const SolverKind kind : kSolvers) read_outs.push_back({std::string(name_of(kind)), {}});
  return read_outs;
}

}  // namespace

Result<NetworkEvaluation> NetworkEvaluation::create(const std::string& model) {
  auto network = Network::load(model, {});
  if (!network) return tl::unexpected(network.error());
  NetworkEvaluation evaluation(std::move(*network));
  for (const SolverKind kind : kSolvers) {
    auto solver = make_solver(kind, kFeatureGrid, kFeatureChannels, kHypotheses,
                              evaluation.network_->solver_parameters());
    if (!solver) return fail("{}: {}", model, solver.error().message);
    evaluation.solvers_.push_back(std::move(*solver));
  }
  return evaluation;
}

SetResult NetworkEvaluation::run(const sim::SampleStream& stream, int frames,
                                 const std::function<void()>& progress) {
  SetResult result;
  result.read_outs = empty_read_outs();
  Overlap overlap;
  const auto wanted = static_cast<uint64_t>(frames);
  uint64_t done = 0;
  for (uint64_t world = 0; done < wanted; ++world) {
    const uint64_t until = std::min(done + kFramesPerWorld, wanted);
    sim::make_samples_of_world(stream, world, 0, [&](const sim::Sample& sample) {
      perceive(sample);
      judge_all(sample.correction, result.read_outs);
      add_overlap(sample, overlap);
      progress();
      return ++done < until;
    });
  }
  for (size_t k = 0; k < kRasterChannels; ++k) {
    const auto either = static_cast<double>(std::max<uint64_t>(overlap.either[k], 1));
    result.iou[k] = static_cast<double>(overlap.both[k]) / either;
  }
  return result;
}

void NetworkEvaluation::perceive(const sim::Sample& sample) {
  update_view_table(sim::told_network_rig(), sample.cameras, kFeatureGrid, view_table_);
  network_->set_view_table(view_table_);
  std::ranges::transform(sample.images, network_->image_input().begin(),
                         [](uint8_t value) { return static_cast<int8_t>(value + kNetworkBlack); });
  std::ranges::copy(sample.raster_prior, network_->raster_input().begin());
  network_->run_image_branch();
  network_->run_map_branch();
  network_->run_mask_head();
}

void NetworkEvaluation::judge_all(const Se2& correction, std::vector<ReadOut>& read_outs) {
  set_no_evidence(kHypotheses, solution_);
  read_outs[0].outcomes.push_back(judge(solution_, kHypotheses, correction));
  for (size_t i = 0; i < solvers_.size(); ++i) {
    solvers_[i]->solve(network_->bev_features(), network_->map_features(), solution_);
    read_outs[i + 1].outcomes.push_back(judge(solution_, kHypotheses, correction));
  }
}

void NetworkEvaluation::add_overlap(const sim::Sample& sample, Overlap& overlap) const {
  const std::span<const float> logits = network_->mask_logits();
  const auto cells = static_cast<size_t>(kRasterGrid.cells());
  for (size_t i = 0; i < logits.size(); ++i) {
    const bool seen = logits[i] > 0.0F;
    const bool drawn = sample.raster_truth[i] > kHalfCovered;
    overlap.both[i / cells] += seen && drawn ? 1 : 0;
    overlap.either[i / cells] += seen || drawn ? 1 : 0;
  }
}

}  // namespace bevloc::evaluation
