#include "evaluation/bench/measurement.h"

#include <algorithm>

#include "evaluation/bench/allocation_count.h"
#include "evaluation/bench/int8_peak.h"
#include "evaluation/bench/machine_peak.h"
#include "evaluation/bench/scene.h"
#include "evaluation/bench/stages.h"
#include "evaluation/bench/whole_frame.h"
#include "evaluation/drive/error_statistics.h"
#include "pipeline/map/map_index.h"

namespace bevloc::bench {
namespace {

/// Size of a group of frames. One more frame warms the caches first and does not count.
constexpr int kGroup = 10;
/// Number of places that are timed. Places where the pose is not tracked are skipped.
constexpr int kPlaces = 4;
constexpr int kMostCandidates = 16;  ///< places that are tried
constexpr int kFramesets = 4;        ///< per place

/// The measurements of one stage.
struct Record {
  std::vector<double> times_ms;
  uint64_t allocations = 0;

  void add(Duration time, uint64_t allocated) {
    times_ms.push_back(kMs_per_s * to_seconds(time));
    allocations += allocated;
  }
};

StageResult result_of(const Stage& stage, const Record& record) {
  const double runs = std::max(1.0, static_cast<double>(record.times_ms.size()));
  return {stage.name, stage.in_frame, stage.work, summarize(record.times_ms),
          static_cast<double>(record.allocations) / runs};
}

/// The median of each field.
MachinePeak median_of(const std::vector<MachinePeak>& rounds) {
  if (rounds.empty()) return {};
  const auto median = [&](double MachinePeak::*field) {
    std::vector<double> values;
    for (const MachinePeak& round : rounds) values.push_back(round.*field);
    return evaluation::quantile_of(values, 0.5);
  };
  return {median(&MachinePeak::convolution_macs_per_s), median(&MachinePeak::matmul_macs_per_s),
          median(&MachinePeak::copy_bytes_per_s)};
}

/// One run of the bench.
class Bench {
 public:
  Bench(const evaluation::DriveConfig& config, const BenchOptions& options)
      : config_(config), options_(options) {}

  Status prepare(MemoryResult& memory);
  Status run(const std::function<void(int, int)>& progress);
  void write(BenchResult& result) const;

 private:
  void keep_if_tracked(Place place);
  bool is_short_of_places() const;
  bool is_chosen(const std::string& stage) const;
  void warm_up(const Place& place);
  Status time_whole_frames(const Place& place, int frames);
  void measure_peak();
  void time_stages(const Place& place, int frames);
  const FramesetImages& next_images(const Place& place);

  const evaluation::DriveConfig& config_;
  const BenchOptions& options_;
  Scene scene_;
  std::unique_ptr<MapIndex> index_;
  std::unique_ptr<WholeFrame> whole_;
  std::unique_ptr<Stages> stages_;
  std::vector<Record> records_;
  Record whole_record_;
  std::vector<MachinePeak> peaks_;  ///< one per place
  ResidentMemory memory_;           ///< before the first peak is measured
  uint64_t frameset_ = 0;
};

Status Bench::prepare(MemoryResult& memory) {
  memory.program_mib = resident_memory().now_mib;
  const auto drawer = SceneDrawer::create(config_);
  if (!drawer) return tl::unexpected(drawer.error());
  double before_mib = resident_memory().now_mib;
  scene_ = {drawer->rig(), drawer->map(), {}};
  index_ = std::make_unique<MapIndex>(scene_.map);
  memory.map_mib = resident_memory().now_mib - before_mib;

  Place first = drawer->draw(0, kFramesets);
  before_mib = resident_memory().now_mib;
  auto whole = WholeFrame::create(config_, scene_.rig, scene_.map, *index_, options_.threads);
  if (!whole) return tl::unexpected(whole.error());
  whole_ = std::move(*whole);
  keep_if_tracked(std::move(first));
  memory.appliance_mib = resident_memory().now_mib - before_mib;

  for (int i = 1; i < kMostCandidates && is_short_of_places(); ++i) {
    keep_if_tracked(drawer->draw(i, kFramesets));
  }
  if (scene_.places.empty()) {
    return fail(
        "{}: found none of {} places where the pose is tracked within {} frames, wanted one",
        config_.model_file.string(), kMostCandidates, WholeFrame::kMostFrames);
  }
  memory.images_mib = scene_.images_mib();
  auto stages = Stages::create(config_, scene_, *index_, options_.threads);
  if (!stages) return tl::unexpected(stages.error());
  stages_ = std::move(*stages);
  records_.resize(stages_->all().size());
  return {};
}

void Bench::keep_if_tracked(Place place) {
  if (whole_->settle(place)) scene_.places.push_back(std::move(place));
}

bool Bench::is_short_of_places() const {
  return static_cast<int>(scene_.places.size()) < std::min(kPlaces, options_.frames);
}

bool Bench::is_chosen(const std::string& stage) const {
  return options_.stages.empty() || std::ranges::count(options_.stages, stage) > 0;
}

const FramesetImages& Bench::next_images(const Place& place) {
  return place.framesets[frameset_++ % place.framesets.size()];
}

void Bench::warm_up(const Place& place) {
  whole_->settle(place);
  stages_->go_to(place);
  stages_->begin_frame(next_images(place));
  for (const Stage& stage : stages_->all()) stage.run();
}

Status Bench::time_whole_frames(const Place& place, int frames) {
  whole_->run(next_images(place));
  int timed = 0;
  for (int tries = 0; timed < frames && tries < 2 * frames; ++tries) {
    const FrameRun run = whole_->run(next_images(place));
    if (run.tracked) {
      whole_record_.add(run.time, run.allocations);
      ++timed;
    } else {
      // Where the pose is not tracked, the search may be wider, which would change the times.
      whole_->settle(place);
    }
  }
  if (timed < frames) {
    return fail("{}: found the pose tracked in {} of {} frames at one place, wanted {}",
                config_.model_file.string(), timed, 2 * frames, frames);
  }
  return {};
}

void Bench::time_stages(const Place& place, int frames) {
  const drivers::MonotonicClock clock;
  for (int i = -1; i < frames; ++i) {
    stages_->begin_frame(next_images(place));
    for (size_t s = 0; s < records_.size(); ++s) {
      const Stage& stage = stages_->all()[s];
      if (!is_chosen(stage.name)) continue;
      const uint64_t allocated_before = allocation_count();
      const Time start = clock.now();
      stage.run();
      const Duration time = clock.now() - start;
      const uint64_t allocated = allocation_count() - allocated_before;
      if (i >= 0) records_[s].add(time, allocated);
    }
  }
}

Status Bench::run(const std::function<void(int, int)>& progress) {
  const int places = static_cast<int>(scene_.places.size());
  int done = 0;
  for (int p = 0; p < places; ++p) {
    const Place& place = scene_.places[static_cast<size_t>(p)];
    warm_up(place);
    const int until = options_.frames * (p + 1) / places;
    while (done < until) {
      const int frames = std::min(kGroup, until - done);
      if (options_.stages.empty()) {
        if (Status status = time_whole_frames(place, frames); !status) return status;
      }
      time_stages(place, frames);
      done += frames;
      progress(done, options_.frames);
    }
    measure_peak();
  }
  return {};
}

/// Measures the peak after each place, so that a machine that becomes slower affects stages and
/// peak alike.
void Bench::measure_peak() {
  if (peaks_.empty()) memory_ = resident_memory();
  if (options_.measures_peak) peaks_.push_back(measure_machine(options_.threads));
}

void Bench::write(BenchResult& result) const {
  result.model = whole_->model_name();
  result.frames = options_.frames;
  result.threads = options_.threads;
  result.places = static_cast<int>(scene_.places.size());
  result.allocations_counted = malloc_is_counted();
  result.peak = median_of(peaks_);
  result.memory.process = memory_;
  for (size_t s = 0; s < records_.size(); ++s) {
    const Stage& stage = stages_->all()[s];
    if (is_chosen(stage.name)) result.stages.push_back(result_of(stage, records_[s]));
  }
  if (options_.stages.empty()) {
    result.whole_frame = result_of({"whole frame", true, {}, {}}, whole_record_);
  }
}

}  // namespace

double BenchResult::sum_of_stages_ms() const {
  double sum_ms = 0.0;
  for (const StageResult& stage : stages) sum_ms += stage.in_frame ? stage.time.p50_ms : 0.0;
  return sum_ms;
}

double BenchResult::sum_of_ideals_ms() const {
  double sum_s = 0.0;
  for (const StageResult& stage : stages) {
    sum_s += stage.in_frame ? ideal_s(stage.work, peak) : 0.0;
  }
  return kMs_per_s * sum_s;
}

double BenchResult::outside_ms() const {
  return whole_frame ? whole_frame->time.p50_ms - sum_of_stages_ms() : 0.0;
}

Result<BenchResult> run_bench(const evaluation::DriveConfig& config, const BenchOptions& options,
                              const std::function<void(int done, int all)>& progress) {
  BenchResult result;
  Bench bench(config, options);
  if (Status status = bench.prepare(result.memory); !status) {
    return tl::unexpected(status.error());
  }
  if (Status status = bench.run(progress); !status) return tl::unexpected(status.error());
  bench.write(result);
  result.processor = processor_name();
  result.instruction_set = instruction_set();
  return result;
}

}  // namespace bevloc::bench
