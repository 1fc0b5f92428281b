// Finds the files that come with bevloc: demo configuration, rigs, networks.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace bevloc {

/// A file that comes with bevloc, "models/nano.onnx": in the present folder, in the tree that this
/// program was built in, or in /usr/share/bevloc. Nothing if it is in none of them.
std::optional<std::filesystem::path> shipped_file(const std::filesystem::path& name);

/// The file if it is there, else the shipped one of this name. The name itself if there is none, so
/// that an error can say it.
std::string given_or_shipped(const std::string& name);

}  // namespace bevloc
