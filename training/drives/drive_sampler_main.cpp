// bevloc_drive_sampler: makes training samples of recorded drives and writes them to standard
// output, without end, in the form of training/native/sample_record.h. training/sampler_process.py
// starts it.
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/option_checks.h"
#include "evaluation/choice_option.h"
#include "pipeline/calibration/rig_yaml.h"
#include "pipeline/map/map_index.h"
#include "pipeline/map/map_loader.h"
#include "sim/random.h"
#include "training/drives/drive_sample.h"
#include "training/drives/drive_set.h"
#include "training/native/record_output.h"

namespace {

using bevloc::drives::DrivePart;
using bevloc::drives::DriveSample;
using bevloc::drives::DriveSampleMaker;
using bevloc::drives::DriveSet;
using bevloc::drives::kDriveParts;
using bevloc::drives::ReferenceKind;
using bevloc::drives::SamplePlace;

constexpr const char* kProgram = "bevloc_drive_sampler";
constexpr int kExitBadSamples = 1;

struct Options {
  std::string recordings;
  std::string map;
  std::string rig;
  ReferenceKind reference = ReferenceKind::kFile;
  DrivePart part = DrivePart::kTraining;
  uint64_t first_seed = 0;
  uint64_t first_sample = 0;
  uint64_t stride = 1;
  double drop_camera_probability = 0.0;
  bool skip = false;
  bool blank = false;
  bool count = false;
  bool check = false;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("--recordings", options.recordings, "Folder of recorded drives")->required();
  app.add_option("--map", options.map, "HD map of all drives")->required();
  app.add_option("--rig", options.rig, "Calibration of all drives, instead of the recorded one");
  bevloc::evaluation::add_choice(
      app, "--reference", options.reference,
      {{"file", ReferenceKind::kFile},
       {"own", ReferenceKind::kOwn},
       {"truth", ReferenceKind::kTruth}},
      "Reference poses: file (reference.csv), own (where bevloc was sure) or truth (of a "
      "simulated drive)");
  bevloc::evaluation::add_choice(app, "--part", options.part,
                                 {kDriveParts.begin(), kDriveParts.end()},
                                 "Places: training, calibration or held-back");
  app.add_option("--first-seed", options.first_seed, "Seed of order, priors and missing cameras")
      ->check(bevloc::whole_number());
  app.add_option("--first-sample", options.first_sample, "Number of the first sample to write")
      ->check(bevloc::whole_number());
  app.add_option("--stride", options.stride, "Write the first of every N samples")
      ->check(CLI::Range(1, 1024));
  app.add_option("--drop-camera-probability", options.drop_camera_probability,
                 "Probability that a sample lacks one or two cameras")
      ->check(bevloc::number_between(0.0, 1.0));
  app.add_flag("--skip-bad", options.skip, "Replace a bad sample by the next good one");
  app.add_flag("--blank-bad", options.blank,
               "Write zeros in place of a bad sample, which then has no camera")
      ->excludes("--skip-bad");
  app.add_flag("--count", options.count,
               "Print the number of samples of each part, and the ranges of the network cameras' "
               "focal lengths and heights, and end");
  app.add_flag("--check", options.check, "Read every sample once, name the bad ones, and end");
}

void print_counts(const DriveSet& set) {
  for (const auto& [name, part] : kDriveParts) fmt::print("{} {}\n", name, set.places(part).size());
  const auto ranges = set.camera_ranges();
  fmt::print("focal_px {:.6g} {:.6g}\n", ranges.least_focal_px, ranges.most_focal_px);
  fmt::print("height_m {:.6g} {:.6g}\n", ranges.least_height_m, ranges.most_height_m);
}

/// Reads every sample of all parts once.
int check(DriveSet& set, DriveSampleMaker& maker) {
  size_t bad = 0;
  DriveSample sample;
  for (const auto& [name, part] : kDriveParts) {
    for (const SamplePlace& place : set.places(part)) {
      const auto made = maker.make(place, bevloc::drives::random_choice(0, 0, 0.0), sample);
      if (made) continue;
      ++bad;
      fmt::print("bad sample: {}\n", made.error().message);
    }
  }
  const auto& left_out = set.left_out();
  fmt::print(
      "{} drives: {} samples for training, {} for calibration, {} held back, {} of them bad\n"
      "left out: {} framesets without a reference pose, {} close to the one before, {} beside a "
      "place of another part\n",
      set.drives(), set.places(DrivePart::kTraining).size(),
      set.places(DrivePart::kCalibration).size(), set.places(DrivePart::kHeldBack).size(), bad,
      left_out.without_pose, left_out.too_close, left_out.beside_other_part);
  return bad == 0 ? 0 : kExitBadSamples;
}

/// An endless order of places: each place once in every epoch, in another random order.
class EndlessOrder {
 public:
  EndlessOrder(const std::vector<SamplePlace>& places, uint64_t seed)
      : places_(places), seed_(seed) {}

  const SamplePlace& at(uint64_t number) {
    const uint64_t epoch = number / places_.size();
    if (epoch != epoch_) {
      epoch_ = epoch;
      shuffle(epoch);
    }
    return shuffled_[number % places_.size()];
  }

 private:
  void shuffle(uint64_t epoch) {
    shuffled_ = places_;
    bevloc::sim::Random random(bevloc::sim::seed_for(seed_, "order") + epoch);
    for (size_t i = places_.size(); i > 1; --i) {
      std::swap(shuffled_[i - 1], shuffled_[random.index(i)]);
    }
  }

  const std::vector<SamplePlace>& places_;
  const uint64_t seed_;
  std::optional<uint64_t> epoch_;
  std::vector<SamplePlace> shuffled_;
};

/// Makes a sample that depends on its number alone. With --skip-bad, the next good place in the
/// order replaces that of a bad sample. Returns whether there was a good one.
bool make_sample(const Options& options, uint64_t number, EndlessOrder& order,
                 DriveSampleMaker& maker, uint64_t most_places, DriveSample& sample) {
  const auto choice =
      bevloc::drives::random_choice(options.first_seed, number, options.drop_camera_probability);
  for (uint64_t ahead = 0; ahead < most_places; ++ahead) {
    const auto made = maker.make(order.at(number + ahead), choice, sample);
    if (made) return true;
    fmt::print(stderr, "bad sample: {}\n", made.error().message);
  }
  return false;
}

/// Writes samples without end. Returns only if a sample is bad or writing fails.
int write_samples(const Options& options, DriveSet& set, DriveSampleMaker& maker) {
  const std::vector<SamplePlace>& places = set.places(options.part);
  if (places.empty()) {
    fmt::print(stderr,
               "{}: found no sample of this part, wanted some; give drives with reference poses "
               "through more squares of {:g} m\n",
               options.recordings, bevloc::drives::kSquare_m);
    return bevloc::kBadInput;
  }
  if (!bevloc::write_output(bevloc::sample_stream_header(), kProgram)) return kExitBadSamples;
  EndlessOrder order(places, options.first_seed);
  // Two lengths of the part contain at least one whole epoch.
  const uint64_t most_places = options.skip ? 2 * places.size() : 1;
  std::vector<uint8_t> record;
  DriveSample sample;
  for (uint64_t i = options.first_sample;; i += options.stride) {
    if (make_sample(options, i, order, maker, most_places, sample)) {
      bevloc::write_sample_record(sample.content(), record);
    } else if (options.blank) {
      record.assign(bevloc::sample_record_size(), 0);
    } else {
      return kExitBadSamples;
    }
    if (!bevloc::write_output(record, kProgram)) return kExitBadSamples;
  }
}

int run(const Options& options) {
  const auto refuse = [](const bevloc::Error& error) {
    fmt::print(stderr, "{}\n", error.message);
    return bevloc::kBadInput;
  };
  bevloc::drives::DriveSetOptions chosen{options.recordings, options.reference, std::nullopt};
  if (!options.rig.empty()) {
    const auto rig = bevloc::read_rig(options.rig);
    if (!rig) return refuse(rig.error());
    chosen.rig = *rig;
  }
  auto set = DriveSet::open(chosen);
  if (!set) return refuse(set.error());
  if (options.count) {
    print_counts(*set);
    return 0;
  }
  const auto map = bevloc::load_map(options.map);
  if (!map) return refuse(map.error());
  const bevloc::MapIndex index(*map);
  DriveSampleMaker maker(*set, index);
  if (options.check) return check(*set, maker);
  if (!bevloc::output_is_pipe(kProgram)) return bevloc::kBadInput;
  return write_samples(options, *set, maker);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Writes samples of recorded drives to standard output (docs/own-drives.md)."};
  Options options;
  add_options(app, options);
  if (const auto ended = bevloc::parse_options(app, argc, argv)) return *ended;
  return run(options);
}
