// The six surround cameras: their number, names and fixed order.
#pragma once

#include <array>
#include <bitset>
#include <string_view>

namespace bevloc {

inline constexpr int kCameraCount = 6;

/// The order of the cameras in framesets, in the network's input, in masks and in YAML.
inline constexpr std::array<std::string_view, kCameraCount> kCameraNames = {
    "front_left", "front", "front_right", "back_left", "back", "back_right"};

/// A set of cameras: bit i is camera i.
using CameraMask = std::bitset<kCameraCount>;

}  // namespace bevloc
