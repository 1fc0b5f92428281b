// Prints the frames of a candump log as JSON, decoded by a DBC file: print_decoded FILE.dbc
// FILE.log
#include <cstdio>
#include <vector>

#include "can/bus/candump.h"
#include "can/listen/bus_listener.h"

int main(int argc, char** argv) {
  using namespace bevloc;
  auto dbc = can::read_dbc_file(argc == 3 ? argv[1] : "");
  const auto log = can::read_candump_file(argc == 3 ? argv[2] : "");
  if (!dbc || !log) {
    std::fprintf(stderr, "%s\n", (dbc ? log.error() : dbc.error()).message.c_str());
    return 2;
  }
  std::vector<can::Dbc> files;
  files.push_back(std::move(*dbc));
  can::BusListener listener(std::move(files), {});
  for (const can::CandumpEntry& entry : *log) {
    const can::DecodedFrame* decoded = listener.decode(entry.frame);
    if (decoded != nullptr) std::puts(can::json_of(*decoded, 0.0).c_str());
  }
}
