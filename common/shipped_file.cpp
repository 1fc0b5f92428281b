#include "common/shipped_file.h"

#include <system_error>

#include "common/replace_process.h"

namespace bevloc {

std::optional<std::filesystem::path> shipped_file(const std::filesystem::path& name) {
  std::error_code error;
  // The program lies in build/PRESET/bin of the tree.
  const auto tree = folder_of_this_program().parent_path().parent_path().parent_path();
  for (const std::filesystem::path& folder :
       {std::filesystem::current_path(error), tree, std::filesystem::path("/usr/share/bevloc")}) {
    if (std::filesystem::is_regular_file(folder / name, error)) return folder / name;
  }
  return std::nullopt;
}

std::string given_or_shipped(const std::string& name) {
  std::error_code error;
  if (std::filesystem::exists(name, error)) return name;
  const auto shipped = shipped_file(name);
  return shipped ? shipped->string() : name;
}

}  // namespace bevloc
