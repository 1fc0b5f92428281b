// Maps whole files into memory.
#pragma once

#include <filesystem>
#include <string_view>
#include <utility>

#include "common/result.h"

namespace bevloc {

/// The bytes of a file, for reading. Unmaps them at its end. Moving it does not move the bytes.
/// Thread-safe.
class MappedFile {
 public:
  /// Fails if the file is not readable, is no regular file or is empty. `wanted` ends the message:
  /// "a compact map". The file may grow while it is mapped, but must not become shorter.
  static Result<MappedFile> open(const std::filesystem::path& path, std::string_view wanted);

  MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}
  MappedFile& operator=(MappedFile&& other) noexcept {
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~MappedFile();

  std::string_view bytes() const { return bytes_; }

 private:
  explicit MappedFile(std::string_view bytes) : bytes_(bytes) {}

  std::string_view bytes_;  ///< empty after it was moved from
};

}  // namespace bevloc
