#include "common/mapped_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "common/file_descriptor.h"

namespace bevloc {

Result<MappedFile> MappedFile::open(const std::filesystem::path& path, std::string_view wanted) {
  errno = 0;
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat status {};
  if (file.get() < 0 || fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode) ||
      status.st_size == 0) {
    return fail("{}: found no readable file ({}), wanted {}", path.string(), std::strerror(errno),
                wanted);
  }
  const auto size = static_cast<size_t>(status.st_size);
  void* bytes = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
  if (bytes == MAP_FAILED) {
    return fail("{}: cannot map {} bytes into memory ({})", path.string(), size,
                std::strerror(errno));
  }
  return MappedFile(std::string_view(static_cast<const char*>(bytes), size));
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) munmap(const_cast<char*>(bytes_.data()), bytes_.size());
}

}  // namespace bevloc
