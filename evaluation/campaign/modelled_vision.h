// Stands in for cameras and vision stage: reports the modelled matches of a simulated drive.
#pragma once

#include <memory>
#include <vector>

#include "drivers/camera/stamp_steps.h"
#include "evaluation/campaign/match_model.h"
#include "evaluation/campaign/modes/fault_time.h"
#include "evaluation/campaign/modes/match_fault.h"
#include "firmware/stages/messages.h"
#include "firmware/stages/prior_source.h"
#include "sim/vehicle/drive.h"

namespace bevloc::evaluation {

/// Makes ten framesets per second. Each takes its prior from the estimation stage's predictions, as
/// the vision stage does, and is reported 30 ms after its exposure, as in lockstep. One thread.
class ModelledVision {
 public:
  struct Faults {
    FaultTime time;
    std::vector<MatchFault> faults;
  };

  /// The queues must outlive this object.
  ModelledVision(MatchModel model, std::shared_ptr<const sim::Drive> drive, Time drive_start,
                 Faults faults, firmware::PredictionQueue& predictions,
                 firmware::VisionQueue& reports);

  /// Call it once per bus cycle.
  void step(Time now);

 private:
  void report(double time_s);
  MatchResult match(const Se2& prior, const Se2& truth, SearchRange range, double time_s);
  const MatchFault* active(MatchFaultKind kind, double time_s) const;

  MatchModel model_;
  std::shared_ptr<const sim::Drive> drive_;
  Time drive_start_;
  Faults faults_;
  firmware::PriorSource priors_;
  firmware::VisionQueue& reports_;
  drivers::StampSteps stamp_steps_;
  int frame_ = 0;
  double distance_m_ = 0.0;
  Se2 last_truth_;
};

}  // namespace bevloc::evaluation
