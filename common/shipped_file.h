// Finds the files that come with bevloc: demo configuration, rigs, networks.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace bevloc {

/// Finds a file that comes with bevloc, such as "models/nano.onnx". Looks in the current folder,
/// then in the tree that this program was built in, then in /usr/share/bevloc. Returns nothing if
/// the file is in none of them.
std::optional<std::filesystem::path> shipped_file(const std::filesystem::path& name);

/// Returns `name` if this file exists, and otherwise the path of the shipped file of this name. If
/// there is neither, returns `name`, so that an error message can show it.
std::string given_or_shipped(const std::string& name);

}  // namespace bevloc
