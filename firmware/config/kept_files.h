// Keeps the bytes of files as they were when they were read.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "common/files.h"

namespace bevloc::firmware {

/// The bytes of small files. bevlocd runs for days with what it read at its start, and somebody may
/// change a file meanwhile. So what bevlocd says about a file stays true of the bytes that it uses.
class KeptFiles {
 public:
  /// Reads a file and keeps its bytes. Keeps nothing of a file that cannot be read.
  void keep(const std::filesystem::path& file) {
    if (auto bytes = read_file(file)) bytes_.insert_or_assign(file, std::move(*bytes));
  }

  /// Returns the bytes that were kept. Reads the file now if there are none.
  Result<std::string> bytes_of(const std::filesystem::path& file) const {
    const auto kept = bytes_.find(file);
    return kept != bytes_.end() ? Result<std::string>(kept->second) : read_file(file);
  }

 private:
  std::map<std::filesystem::path, std::string> bytes_;
};

}  // namespace bevloc::firmware
