// bevloc_sampler: renders the simulator's samples for training and writes them to standard output,
// without end, in the form of training/native/sample_record.h. It ends when nobody reads any more.
// training/sampler_process.py starts it. It needs neither Python nor the network's engine, so a
// training bundle can carry it to another machine.
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/option_checks.h"
#include "sim/render/photo_library.h"
#include "sim/samples/sample_maker.h"
#include "sim/samples/training_nuisances.h"
#include "training/native/record_output.h"
#include "training/native/sample_queue.h"
#include "training/native/sample_record.h"

namespace {

using bevloc::sim::PhotoLibrary;
using bevloc::sim::SampleStream;
using bevloc::sim::TrainingNuisances;

constexpr const char* kProgram = "bevloc_sampler";

struct Options {
  uint64_t first_seed = 0;
  uint64_t first_sample = 0;
  int threads = 1;
  double drop_camera_probability = 0.0;
  std::string nuisances = "usual";
  std::string photos;
};

const std::map<std::string, TrainingNuisances (*)()>& nuisances_by_name() {
  static const std::map<std::string, TrainingNuisances (*)()> kNuisances = {
      {"usual", [] { return TrainingNuisances{}; }},
      {"strong", &bevloc::sim::strong_nuisances},
      {"street", &bevloc::sim::street_nuisances}};
  return kNuisances;
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("--first-seed", options.first_seed, "Seed of the stream's first world")
      ->check(bevloc::whole_number());
  app.add_option("--first-sample", options.first_sample, "Number of the first sample to write")
      ->check(bevloc::whole_number());
  app.add_option("--threads", options.threads, "Threads that render ahead")
      ->check(CLI::Range(1, 1024));
  app.add_option("--drop-camera-probability", options.drop_camera_probability,
                 "Probability that a sample lacks one or two cameras")
      ->check(bevloc::number_between(0.0, 1.0));
  app.add_option("--nuisances", options.nuisances, "Disturbances of the samples")
      ->check(CLI::IsMember(nuisances_by_name()));
  app.add_option("--photos", options.photos,
                 "Folder of script/photos; without it all textures are the simulator's own");
}

/// Returns only if writing fails. A reader that goes away ends the program by SIGPIPE.
int write_samples(const Options& options) {
  std::unique_ptr<const PhotoLibrary> photos;
  if (!options.photos.empty()) {
    auto loaded = PhotoLibrary::load(options.photos);
    if (!loaded) {
      std::fprintf(stderr, "%s\n", loaded.error().message.c_str());
      return bevloc::kBadInput;
    }
    photos = std::make_unique<PhotoLibrary>(std::move(*loaded));
  }
  SampleStream stream;
  stream.first_seed = options.first_seed;
  stream.nuisances.missing_cameras.probability = options.drop_camera_probability;
  stream.training = nuisances_by_name().at(options.nuisances)();
  bevloc::SampleQueue queue(stream, std::move(photos), options.first_sample, options.threads);
  bool written = bevloc::write_output(bevloc::sample_stream_header(), kProgram);
  for (std::vector<uint8_t> record; written; written = bevloc::write_output(record, kProgram)) {
    bevloc::write_sample_record(queue.next().content(), record);
  }
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Writes simulated samples for training to standard output (training/README.md)."};
  Options options;
  add_options(app, options);
  if (const auto ended = bevloc::parse_options(app, argc, argv)) return *ended;
  if (!bevloc::output_is_pipe(kProgram)) return bevloc::kBadInput;
  return write_samples(options);
}
