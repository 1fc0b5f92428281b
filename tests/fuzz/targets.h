// What is fuzzed: one function for each large parser of data from outside. libFuzzer calls it
// with the inputs that it invents (script/fuzz), fuzz_corpus_test with the stored ones.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace bevloc::fuzz {

using Bytes = std::span<const uint8_t>;

/// Each parses the bytes and checks what must hold for whatever was accepted. Ends the program if
/// it does not hold.
void run_bvm(Bytes bytes);
void run_calibration(Bytes bytes);
void run_can_frames(Bytes bytes);
void run_candump(Bytes bytes);
void run_config(Bytes bytes);
void run_dbc(Bytes bytes);
void run_frames_txt(Bytes bytes);
void run_gpsd(Bytes bytes);
void run_image_file(Bytes bytes);
void run_map_json(Bytes bytes);
void run_mcap(Bytes bytes);
void run_mjpeg(Bytes bytes);
void run_onnx(Bytes bytes);
void run_osm(Bytes bytes);
void run_rig(Bytes bytes);
void run_xodr(Bytes bytes);

struct Target {
  std::string_view name;
  void (*run)(Bytes bytes);
};

inline constexpr Target kTargets[] = {
    {"bvm", run_bvm},
    {"calibration", run_calibration},
    {"can_frames", run_can_frames},
    {"candump", run_candump},
    {"config", run_config},
    {"dbc", run_dbc},
    {"frames_txt", run_frames_txt},
    {"gpsd", run_gpsd},
    {"image_file", run_image_file},
    {"map_json", run_map_json},
    {"mcap", run_mcap},
    {"mjpeg", run_mjpeg},
    {"onnx", run_onnx},
    {"osm", run_osm},
    {"rig", run_rig},
    {"xodr", run_xodr},
};

/// Ends the program with the message unless the condition holds, in every build type.
void expect(bool condition, const char* message);

/// The path of a file in memory with these bytes, valid until the next call.
std::string path_of_file_with(Bytes bytes);

inline std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace bevloc::fuzz
