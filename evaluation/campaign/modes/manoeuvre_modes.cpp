// Modes in which the vehicle crawls, stands or reverses.
#include <utility>

#include "evaluation/campaign/modes/mode_list.h"

namespace bevloc::evaluation {

using sim::FaultKind;

std::vector<Mode> manoeuvre_modes() {
  const std::vector<sim::PacePoint> standing{{0.0, 0.0}, {20.0, 0.0}, {26.0, 1.0}};
  const std::vector<sim::PacePoint> leaving{{0.0, 0.0},  {3.0, 0.0},  {5.0, -0.3}, {11.0, -0.3},
                                            {13.0, 0.0}, {15.0, 0.0}, {21.0, 1.0}};
  const std::vector<sim::PacePoint> reversing{{0.0, 1.0},   {6.0, 0.0},  {8.0, 0.0},  {10.0, -0.3},
                                              {16.0, -0.3}, {18.0, 0.0}, {20.0, 0.0}, {26.0, 1.0}};
  const sim::Fault no_heading = fault(FaultKind::kGnssNoHeading);
  const sim::Fault outage = fault(FaultKind::kGnssOutage);
  ModeList modes;
  modes.add("crawl", "the vehicle drives at a tenth of its speed", kToTheEnd,
            {{0.0, 1.0}, {4.0, 0.1}}, {});
  modes.add("standing-start", "the vehicle stands for the first 20 s", kAlways, standing, {});
  modes.add("standing-start-no-heading",
            "the vehicle stands for the first 20 s, and GNSS has no heading", kAlways, standing,
            {no_heading});
  modes.add("reverse-start", "the vehicle leaves its place backwards", kAlways, leaving, {});
  modes.add("reverse-start-no-heading",
            "the vehicle leaves its place backwards, and GNSS has no heading", kAlways, leaving,
            {no_heading});
  modes.add("reverse", "the vehicle stops, reverses and drives on", kToTheEnd, reversing, {});
  modes.add("reverse-without-gnss", "the vehicle stops and reverses while GNSS is missing",
            kToTheEnd, reversing, {outage});
  return std::move(modes).all();
}

}  // namespace bevloc::evaluation
