#include "evaluation/drive/bus_log.h"

#include "can/bus/candump.h"

namespace bevloc::evaluation {

Result<BusLog> BusLog::create(const std::filesystem::path& path) {
  BusLog log(path);
  if (!log.file_) {
    return fail("{}: found no way to create the bus log, wanted a folder that can be written",
                path.string());
  }
  return log;
}

void BusLog::add(Duration time, const can::Frame& frame) {
  constexpr const char* kInterfaceInLog = "can0";
  file_ << can::candump_line(time, kInterfaceInLog, frame) << '\n';
}

Status BusLog::finish() {
  if (file_.flush()) return {};
  return fail("{}: found no room for the whole bus log, wanted a disk that is not full",
              path_.string());
}

}  // namespace bevloc::evaluation
