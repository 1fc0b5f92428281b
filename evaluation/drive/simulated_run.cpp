#include "evaluation/drive/simulated_run.h"

#include <algorithm>
#include <cmath>

#include "common/files.h"
#include "evaluation/drive/bus_factory.h"
#include "evaluation/drive/clock_faults.h"
#include "evaluation/drive/fault_socket.h"
#include "evaluation/drive/faulty_bus.h"
#include "evaluation/drive/jumping_clock.h"
#include "evaluation/drive/picture_recorder.h"
#include "evaluation/drive/progress_line.h"
#include "evaluation/drive/simulated_drive.h"
#include "evaluation/drive/snapshot_keeper.h"
#include "firmware/live/live_server.h"
#include "firmware/recording/recorder_thread.h"
#include "firmware/recording/recording_session.h"
#include "firmware/runtime/calibration_saver.h"
#include "firmware/runtime/runner.h"
#include "firmware/runtime/supervisor.h"

namespace bevloc::evaluation {
namespace {

/// Time for the cameras to render their first images before the drive begins.
constexpr Duration kLead = std::chrono::milliseconds(500);

/// The latencies of one drive. The CAN-out thread writes; report() is called after the run.
class LatencyRecorder {
 public:
  explicit LatencyRecorder(double duration_s) {
    constexpr double kMostCorrectionsPerSecond = 100.0;
    latencies_ms_.reserve(static_cast<size_t>(duration_s * kMostCorrectionsPerSecond) + 1);
  }
  void add(Duration latency) { latencies_ms_.push_back(to_milliseconds(latency)); }
  LatencyReport report() const {
    return {quantile_of(latencies_ms_, 0.5), quantile_of(latencies_ms_, 0.99)};
  }

 private:
  std::vector<double> latencies_ms_;
};

/// All parts of one simulated drive.
class SimulatedRun {
 public:
  static Result<std::unique_ptr<SimulatedRun>> create(const DriveConfig& config, const Rig& rig,
                                                      const SimulatedRunOptions& options);

  void run(const StopWhen& stop);
  /// Makes the folder of the pictures ready, if there is one.
  Status begin_recording() { return recorder_ ? recorder_->begin() : Status(); }
  /// Completes the bus log.
  Status finish_log() { return judge_->finish(); }
  DriveReport report() const;
  /// Writes the indexes, the reference and the map, with which the pictures become a recording.
  Status finish_recording();
  /// Frees the appliance first, so it must be the last call.
  Status write_sheet_if_any();

 private:
  SimulatedRun(const DriveConfig& config, const Rig& rig, const SimulatedRunOptions& options,
               SimulatedDrive drive);
  Status connect();
  void suspend_if_due(Time now);
  void jump_if_due(double time_s);
  void record_truth(Time now);
  const JudgedPose& judged_nearest(double time_s) const;

  const DriveConfig& config_;
  const Rig& rig_;
  const SimulatedRunOptions& options_;
  SimulatedDrive drive_;
  JumpingClock machine_clock_;
  drivers::VirtualClock virtual_clock_;
  drivers::Clock& clock_;
  Time log_start_;
  Time drive_start_;
  BusFactory buses_;
  firmware::Realtime realtime_;
  SnapshotKeeper keeper_;
  std::optional<PictureRecorder> recorder_;  ///< set if there is a pictures_folder
  LatencyRecorder latencies_;
  std::unique_ptr<firmware::Recorder> recording_;  ///< null without a recording
  std::unique_ptr<firmware::Appliance> appliance_;
  std::unique_ptr<SimulatedVehicle> vehicle_;
  std::unique_ptr<Judge> judge_;
  std::unique_ptr<firmware::LiveServer> live_;  ///< null without the section `live`
  std::unique_ptr<FaultServer> fault_server_;   ///< null without simulation.fault_socket
  ClockFaults clock_faults_;
  Time next_truth_{};
  double driven_s_ = 0.0;
};

Result<std::unique_ptr<SimulatedRun>> SimulatedRun::create(const DriveConfig& config,
                                                           const Rig& rig,
                                                           const SimulatedRunOptions& options) {
  auto drive = SimulatedDrive::create(config);
  if (!drive) return tl::unexpected(drive.error());
  const auto hanging = drive->faults()->all(sim::FaultInput::kThread);
  if (options.fast && !hanging.empty()) {
    return fail(
        "simulation.faults: found {} with --fast, wanted a drive without, because one thread runs "
        "everything",
        sim::info_of(hanging.front().kind).name);
  }
  auto run =
      std::unique_ptr<SimulatedRun>(new SimulatedRun(config, rig, options, std::move(*drive)));
  if (Status status = run->connect(); !status) return tl::unexpected(status.error());
  return run;
}

SimulatedRun::SimulatedRun(const DriveConfig& config, const Rig& rig,
                           const SimulatedRunOptions& options, SimulatedDrive drive)
    : config_(config),
      rig_(rig),
      options_(options),
      drive_(std::move(drive)),
      clock_(options.fast ? static_cast<drivers::Clock&>(virtual_clock_) : machine_clock_),
      log_start_(clock_.now()),
      drive_start_(log_start_ + kLead),
      buses_(config.can),
      realtime_(config.realtime),
      latencies_(config.simulation->duration_s),
      clock_faults_(drive_.faults()) {
  if (!options.pictures_folder.empty()) recorder_.emplace(options.pictures_folder);
}

Status SimulatedRun::connect() {
  auto own_bus = buses_.connect_appliance();
  auto vehicle_bus = buses_.connect();
  auto judge_bus = buses_.connect();
  for (const auto* bus : {&own_bus, &vehicle_bus, &judge_bus}) {
    if (!*bus) return tl::unexpected(bus->error());
  }
  firmware::Hardware hardware{
      drive_.make_cameras(config_, rig_, clock_, drive_start_, options_.pictures),
      std::make_unique<FaultyBus>(std::move(*own_bus), drive_.faults(), clock_, drive_start_,
                                  config_.simulation->seed),
      &clock_};
  auto recorder = firmware::open_recorder(config_, rig_, drive_.map(), options_.fast, clock_.now());
  if (!recorder) return tl::unexpected(recorder.error());
  recording_ = std::move(*recorder);
  if (recording_) firmware::tap(hardware, *recording_);
  auto appliance = firmware::Appliance::create(config_, rig_, drive_.map(), std::move(hardware));
  if (!appliance) return tl::unexpected(appliance.error());
  appliance_ = std::move(*appliance);
  if (recording_) firmware::watch(*appliance_, *recording_);
  appliance_->vision().observe([this](const firmware::VisionSnapshot& snapshot) {
    drive_.faults()->hang(sim::FaultKind::kHangVision, 0,
                          [this] { return to_seconds(clock_.now() - drive_start_); });
    keeper_.observe(snapshot);
    if (recorder_) recorder_->record(snapshot.frameset);
  });
  appliance_->estimation().observe_corrections(
      [this](Time frame_time) { latencies_.add(clock_.now() - frame_time); });

  const GeoOrigin& origin = drive_.map().origin;
  vehicle_ = std::make_unique<SimulatedVehicle>(drive_, config_.simulation->seed, config_.can,
                                                std::move(*vehicle_bus), drive_start_);
  auto judge = Judge::create(
      std::move(*judge_bus), config_.can, origin,
      [this](double time_s) { return drive_.truth_at(time_s); }, {log_start_, drive_start_},
      (options_.out / "can.log").string());
  if (!judge) return tl::unexpected(judge.error());
  judge_ = std::move(*judge);
  if (config_.live) {
    auto live = firmware::LiveServer::start(*config_.live);
    if (!live) return tl::unexpected(live.error());
    live_ = std::move(*live);
    live_->attach(*appliance_, rig_);
  }
  const std::filesystem::path& socket = config_.simulation->fault_socket;
  if (socket.empty()) return {};
  auto server = FaultServer::open(socket, drive_.faults(),
                                  {drive_.drive()->duration_s(), options_.fast, config_.can});
  if (!server) return tl::unexpected(server.error());
  fault_server_ = std::move(*server);
  return {};
}

void SimulatedRun::run(const StopWhen& stop) {
  const double duration_s = config_.simulation->duration_s;
  const firmware::Companion companion{[this] { return vehicle_->next_due(); },
                                      [this](Time now) {
                                        suspend_if_due(now);
                                        vehicle_->send_due(now);
                                        record_truth(now);
                                      },
                                      [this](Duration timeout) {
                                        judge_->step(timeout);
                                        if (recording_ && options_.fast) {
                                          recording_->write_queued(clock_.now());
                                        }
                                      }};
  const auto saver =
      firmware::make_calibration_saver(config_, rig_, std::as_const(*appliance_).localizer());
  firmware::Watchdog watchdog(appliance_->estimation().counters().state);
  watchdog.watch_stages(*appliance_);
  firmware::Supervisor supervisor(*appliance_, realtime_, watchdog);
  const auto supervise = [&](Time now) {
    watchdog.step(now);
    supervisor.step(now);
    if (live_) {
      live_->publish({firmware::Phase::kRunning, now,
                      firmware::take_snapshot(*appliance_, {.recording = firmware::totals_of(
                                                                config_, recording_.get())}),
                      supervisor.view()});
    }
    const double time_s = to_seconds(now - drive_start_);
    if (fault_server_) fault_server_->step(time_s);
    const bool complete = time_s >= duration_s || drive_.is_over(time_s);
    const bool last = complete || stop(supervisor.view());
    if (last) {
      driven_s_ = complete ? duration_s : std::max(time_s, 0.0);
      drive_.faults()->release();
    } else {
      jump_if_due(time_s);
    }
    if (options_.show_progress) {
      show_progress_line(supervisor.view(), judge_->view(), time_s, duration_s, last);
    }
    return !last;
  };
  if (options_.fast) {
    firmware::run_lockstep(*appliance_, virtual_clock_, &companion, supervise);
    if (recording_) recording_->finish(clock_.now());
  } else {
    std::jthread writing;
    if (recording_) writing = firmware::start_recording(*recording_, clock_);
    firmware::run_threads(*appliance_, realtime_, &companion, supervise);
  }
  if (live_) live_->detach();
  supervisor.finish();
  if (saver) saver->finish();
}

/// Simulates that the machine was suspended while the vehicle drove on.
void SimulatedRun::suspend_if_due(Time now) {
  const Duration length = clock_faults_.suspension_due(to_seconds(now - drive_start_));
  if (length == Duration::zero()) return;
  judge_->note_gap(now);
  if (options_.fast) {
    virtual_clock_.suspend(length);
  } else {
    machine_clock_.suspend(length);
  }
}

/// Records the true pose ten times a second.
void SimulatedRun::record_truth(Time now) {
  if (!recording_ || now < next_truth_ || now < drive_start_) return;
  next_truth_ = now + std::chrono::milliseconds(100);
  recording_->note_truth({now, drive_.truth_at(to_seconds(now - drive_start_))});
}

/// Moves the clock by the gap of a clock fault: time passes, but the appliance does not run.
void SimulatedRun::jump_if_due(double time_s) {
  const Duration gap = clock_faults_.gap_due(time_s);
  if (gap == Duration::zero()) return;
  judge_->note_gap(clock_.now() + gap);
  if (options_.fast) {
    virtual_clock_.advance(gap);
  } else {
    machine_clock_.advance(gap);
  }
}

Status SimulatedRun::finish_recording() {
  if (!recorder_) return {};
  return recorder_->finish(drive_.reference(config_.simulation->seed, drive_start_), drive_.map());
}

DriveReport SimulatedRun::report() const {
  DriveReport report;
  report.prior = judge_->prior_error();
  report.estimate = judge_->estimate_error();
  report.frames = appliance_->frame_counts();
  report.latency = latencies_.report();
  report.realtime_refusals = realtime_.refusals();
  report.can_sent = judge_->localizer_frames();
  report.first_fix_s = judge_->first_fix_s();
  report.valid_share = judge_->valid_share();
  report.seed = config_.simulation->seed;
  report.duration_s = config_.simulation->duration_s;
  report.driven_s = driven_s_;
  report.map = drive_.map().name;
  report.model = std::as_const(*appliance_).localizer().model_name();
  report.poses = judge_->poses();
  return report;
}

const JudgedPose& SimulatedRun::judged_nearest(double time_s) const {
  return *std::min_element(judge_->poses().begin(), judge_->poses().end(),
                           [time_s](const JudgedPose& a, const JudgedPose& b) {
                             return std::abs(a.time_s - time_s) < std::abs(b.time_s - time_s);
                           });
}

Status SimulatedRun::write_sheet_if_any() {
  const std::filesystem::path file = options_.out / "sheet.png";
  std::optional<SnapshotKeeper::Kept> kept = keeper_.take();
  if (!kept || judge_->poses().empty()) {
    std::error_code ignored;
    std::filesystem::remove(file, ignored);  // the sheet of an earlier drive
    return {};
  }
  appliance_.reset();  // frees memory for the sheet
  SheetContent& content = kept->content;
  const double time_s = to_seconds(kept->frame_time - drive_start_);
  const JudgedPose& nearest = judged_nearest(time_s);
  // The judge does not compare at the time of the frameset, so the sheet uses the errors of its
  // nearest comparison.
  const Se2 truth = drive_.truth_at(time_s);
  content.truth = truth;
  content.prior = truth * pose_error(nearest.truth, nearest.prior);
  content.corrected = truth * pose_error(nearest.truth, nearest.estimate);
  return write_sheet(content, rig_, MapIndex(drive_.map()), file.string());
}

}  // namespace

Result<DriveReport> run_simulation(const DriveConfig& config, const Rig& rig,
                                   const SimulatedRunOptions& options, const StopWhen& stop) {
  if (Status made = create_folder(options.out); !made) return tl::unexpected(made.error());
  auto run = SimulatedRun::create(config, rig, options);
  if (!run) return tl::unexpected(run.error());
  if (Status begun = (*run)->begin_recording(); !begun) return tl::unexpected(begun.error());
  (*run)->run(stop);
  if (Status status = (*run)->finish_log(); !status) return tl::unexpected(status.error());
  DriveReport report = (*run)->report();
  if (Status status = write_csv(report, (options.out / "poses.csv").string()); !status) {
    return tl::unexpected(status.error());
  }
  if (Status status = (*run)->finish_recording(); !status) {
    return tl::unexpected(status.error());
  }
  if (Status status = (*run)->write_sheet_if_any(); !status) {
    return tl::unexpected(status.error());
  }
  return report;
}

}  // namespace bevloc::evaluation
