// Owns a file descriptor.
#pragma once

#include <utility>

#include <unistd.h>

namespace bevloc {

/// Closes its file descriptor at its end. A negative number stands for no descriptor, as the system
/// calls return it after an error.
class FileDescriptor {
 public:
  explicit FileDescriptor(int number = -1) : number_(number) {}
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    reset(std::exchange(other.number_, -1));
    return *this;
  }
  ~FileDescriptor() { reset(); }

  int get() const { return number_; }

  /// Closes the descriptor that it owns, if any, and takes the ownership of `number`.
  void reset(int number = -1) {
    const int former = std::exchange(number_, number);
    if (former >= 0) close(former);
  }

 private:
  int number_;
};

}  // namespace bevloc
