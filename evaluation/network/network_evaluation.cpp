#include "evaluation/network/network_evaluation.h"

#include <algorithm>
#include <cmath>

#include "evaluation/baselines/distance_transform.h"
#include "evaluation/baselines/icp.h"
#include "evaluation/baselines/ipm.h"
#include "pipeline/map/rasterizer.h"
#include "pipeline/preprocessing/image_remap.h"
#include "pipeline/solver/posterior.h"
#include "sim/perception/matching_scene.h"

namespace bevloc::evaluation {
namespace {

static_assert(sim::kEvaluationSampleSeedBase + sim::kSampleSeedCount <= sim::kTuningSeedBase);
static_assert(kSamplesTakenPerWorld <= sim::kSamplesPerWorld);
static_assert(kMostFrames / kSamplesTakenPerWorld < kWorldsPerSeed);

const HypothesisGrid kBaselineHypotheses;

/// A cell belongs to a line that covers more than half of it.
constexpr uint8_t kHalfCovered = 127;

/// Calls `evaluate` with the first samples of a stream, kSamplesTakenPerWorld of each world.
void for_each_sample(const sim::SampleStream& stream, int samples,
                     const std::function<void(const sim::Sample&)>& evaluate) {
  const auto wanted = static_cast<uint64_t>(samples);
  uint64_t done = 0;
  for (uint64_t world = 0; done < wanted; ++world) {
    const uint64_t until = std::min(done + kSamplesTakenPerWorld, wanted);
    sim::make_samples_of_world(stream, world, 0, [&](const sim::Sample& sample) {
      evaluate(sample);
      return ++done < until;
    });
  }
}

bool reads(const std::vector<ReadOutCase>& cases, SolverInput input) {
  return std::ranges::find(cases, input, &ReadOutCase::input) != cases.end();
}

}  // namespace

Result<NetworkEvaluation> NetworkEvaluation::create(const std::string& model, ReadOutRows rows,
                                                    int tuning_samples) {
  auto network = Network::load(model, {});
  if (!network) return tl::unexpected(network.error());
  NetworkEvaluation evaluation(std::move(*network));
  if (Status status = evaluation.add_solvers(read_out_cases(rows), tuning_samples); !status) {
    return fail("{}: {}", model, status.error().message);
  }
  if (rows == ReadOutRows::kBaselines || rows == ReadOutRows::kAll) evaluation.add_baselines();
  return evaluation;
}

Status NetworkEvaluation::add_solvers(const std::vector<ReadOutCase>& cases, int tuning_samples) {
  const std::vector<TuningSample> samples = make_tuning_samples(cases, tuning_samples);
  MaskScales mask_scales(samples, &TuningSample::perceived);
  MaskScales true_mask_scales(samples, &TuningSample::truth);
  for (const ReadOutCase& read_out : cases) {
    const SolverCase& c = read_out.solver_case;
    Result<SolverParameters> parameters = network_->solver_parameters();
    const MaskInput* masks = nullptr;
    if (read_out.input == SolverInput::kMasks) {
      parameters = mask_scales.parameters_for(c);
      masks = mask_inputs_.of(c);
    } else if (read_out.input == SolverInput::kTrueMasks) {
      parameters = true_mask_scales.parameters_for(c);
      masks = true_mask_inputs_.of(c);
    }
    if (!parameters) return tl::unexpected(parameters.error());
    auto solver = make_solver(c.solver, c.grid, c.channels, c.hypotheses(), *parameters);
    if (!solver) return tl::unexpected(solver.error());
    readers_.push_back({read_out, std::move(*solver), masks});
  }
  return {};
}

void NetworkEvaluation::add_baselines() {
  baselines_.push_back({"icp", std::make_unique<IterativeClosestPoints>(kBaselineHypotheses)});
  baselines_.push_back(
      {"distance-transform", std::make_unique<DistanceTransformAlignment>(kBaselineHypotheses)});
  baselines_.push_back({"ipm", std::make_unique<InversePerspectiveMapping>(kBaselineHypotheses)});
}

std::vector<TuningSample> NetworkEvaluation::make_tuning_samples(
    const std::vector<ReadOutCase>& cases, int samples) {
  const bool needs_perceived = reads(cases, SolverInput::kMasks);
  const bool needs_truth = reads(cases, SolverInput::kTrueMasks);
  if (!needs_perceived && !needs_truth) return {};
  sim::SampleStream stream;
  stream.first_seed = sim::kTuningSeedBase;
  stream.nuisances = sim::nuisances_of(sim::NuisanceSet::kStandard);
  std::vector<TuningSample> made;
  for_each_sample(stream, samples, [&](const sim::Sample& sample) {
    if (needs_perceived) {
      perceive(sample);
      take_probabilities();
    }
    if (needs_truth) take_truth(sample);
    made.push_back({perceived_, truth_, sample.raster_prior, sample.correction});
  });
  return made;
}

std::vector<ReadOut> NetworkEvaluation::empty_read_outs() const {
  std::vector<ReadOut> read_outs{{"prior", {}, {}}};
  for (const Reader& reader : readers_) {
    read_outs.push_back(
        {std::string(name_of(reader.read_out.solver_case.solver)), reader.read_out, {}});
  }
  for (const NamedBaseline& named : baselines_) read_outs.push_back({named.name, {}, {}});
  return read_outs;
}

SetResult NetworkEvaluation::run(const sim::SampleStream& stream, int samples,
                                 const std::function<void()>& progress) {
  SetResult result;
  result.read_outs = empty_read_outs();
  Overlap overlap;
  for_each_sample(stream, samples, [&](const sim::Sample& sample) {
    perceive(sample);
    judge_all(sample, result.read_outs);
    add_overlap(sample, overlap);
    progress();
  });
  for (size_t k = 0; k < kRasterChannels; ++k) {
    const auto either = static_cast<double>(std::max<uint64_t>(overlap.either[k], 1));
    result.iou[k] = static_cast<double>(overlap.both[k]) / either;
  }
  return result;
}

void NetworkEvaluation::perceive(const sim::Sample& sample) {
  update_view_table(sample.rig, sample.cameras, kFeatureGrid, sample.reference_from_exposure,
                    view_table_);
  network_->set_view_table(view_table_);
  std::ranges::transform(sample.images, network_->image_input().begin(),
                         [](uint8_t value) { return static_cast<int8_t>(value + kNetworkBlack); });
  std::ranges::copy(sample.raster_prior, network_->raster_input().begin());
  network_->run_image_branch();
  network_->run_map_branch();
  network_->run_mask_head();
}

void NetworkEvaluation::take_probabilities() {
  const std::span<const float> logits = network_->mask_logits();
  perceived_.resize(logits.size());
  std::ranges::transform(logits, perceived_.begin(),
                         [](float logit) { return 1.0F / (1.0F + std::exp(-logit)); });
}

void NetworkEvaluation::take_truth(const sim::Sample& sample) {
  truth_.resize(sample.raster_truth.size());
  std::ranges::transform(sample.raster_truth, truth_.begin(),
                         [](uint8_t value) { return static_cast<float>(value) / 255.0F; });
}

void NetworkEvaluation::judge_all(const sim::Sample& sample, std::vector<ReadOut>& read_outs) {
  set_no_evidence(kBaselineHypotheses, solution_);
  read_outs[0].outcomes.push_back(judge(solution_, kBaselineHypotheses, sample.correction));
  if (!mask_inputs_.empty() || !baselines_.empty()) {
    take_probabilities();
    mask_inputs_.take(perceived_, sample.raster_prior);
  }
  if (!true_mask_inputs_.empty()) {
    take_truth(sample);
    true_mask_inputs_.take(truth_, sample.raster_prior);
  }
  const std::span<ReadOut> others = std::span(read_outs).subspan(1);
  judge_solvers(sample.correction, others.first(readers_.size()));
  judge_baselines(sample, others.subspan(readers_.size()));
}

void NetworkEvaluation::judge_solvers(const Se2& correction, std::span<ReadOut> read_outs) {
  for (size_t i = 0; i < readers_.size(); ++i) {
    const Reader& reader = readers_[i];
    const bool masks = reader.masks != nullptr;
    reader.solver->solve(masks ? reader.masks->bev() : network_->bev_features(),
                         masks ? reader.masks->map() : network_->map_features(), solution_);
    read_outs[i].outcomes.push_back(
        judge_pose(solution_, reader.read_out.solver_case.hypotheses(), correction));
  }
}

void NetworkEvaluation::judge_baselines(const sim::Sample& sample, std::span<ReadOut> read_outs) {
  const BaselineInput input{.images = sample.images,
                            .cameras = sample.cameras,
                            .rig = sample.rig,
                            .perceived = perceived_,
                            .raster = sample.raster_prior};
  for (size_t i = 0; i < baselines_.size(); ++i) {
    const Se2 found = baselines_[i].baseline->correct(input);
    read_outs[i].outcomes.push_back(judge(found, sample.correction));
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
