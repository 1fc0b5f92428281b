#include "drivers/clock/clock_discipline.h"

#include <ctime>

#include <sys/timex.h>

#include "common/kernel_time.h"

namespace bevloc::drivers {

ClockDiscipline discipline_of(int answer, const timex& state) {
  ClockDiscipline discipline;
  if (answer < 0) return discipline;
  discipline.synchronized = answer != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
  discipline.max_error = std::chrono::microseconds(state.maxerror);
  discipline.estimated_error = std::chrono::microseconds(state.esterror);
  return discipline;
}

ClockDiscipline read_clock_discipline() {
  timex state{};  // no mode is set, so the call changes nothing
  const int answer = adjtimex(&state);
  return discipline_of(answer, state);
}

WallTime read_wall_time() {
  return {read_clock(CLOCK_REALTIME), read_clock_discipline()};
}

}  // namespace bevloc::drivers
