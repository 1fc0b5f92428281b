// Runs another program in place of this one.
#pragma once

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <unistd.h>

#include "common/result.h"

namespace bevloc {

/// Replaces this process by `program` with these arguments. Returns only if that fails.
inline Status replace_process(const std::filesystem::path& program,
                              std::vector<std::string> arguments) {
  std::string name = program.string();
  std::vector<char*> words{name.data()};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  execv(name.c_str(), words.data());
  return fail("{}: cannot start this program ({}), wanted one that may be executed",
              program.string(), std::strerror(errno));
}

/// Returns the folder of the running program, or an empty path if the kernel does not tell it.
inline std::filesystem::path folder_of_this_program() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
}

}  // namespace bevloc
