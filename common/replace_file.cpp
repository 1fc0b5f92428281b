#include "common/replace_file.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/file_descriptor.h"
#include "common/files.h"
#include "common/writable_folder.h"

namespace bevloc {
namespace {

/// Writes what is in memory to the disk, so that a rename cannot overtake the content.
Status flush_to_disk(const std::filesystem::path& path, int flags) {
  const FileDescriptor file(::open(path.c_str(), flags | O_CLOEXEC));
  if (file.get() >= 0 && ::fsync(file.get()) == 0) return {};
  return fail("{}: cannot write this to disk ({})", path.string(), std::strerror(errno));
}

/// Gives a new file the mode, owner and group of the file `earlier`, if there is one.
Status take_mode_and_owner(const std::filesystem::path& file,
                           const std::filesystem::path& earlier) {
  struct stat found {};
  if (::stat(earlier.c_str(), &found) != 0) return {};
  // Only root may give a file to another user. Others may give it to a group that they are in.
  constexpr auto kSameUser = static_cast<uid_t>(-1);
  [[maybe_unused]] const bool given = ::chown(file.c_str(), found.st_uid, found.st_gid) == 0 ||
                                      ::chown(file.c_str(), kSameUser, found.st_gid) == 0;
  constexpr mode_t kReadWriteExecute = 0777;
  if (::chmod(file.c_str(), found.st_mode & kReadWriteExecute) == 0) return {};
  return fail("{}: cannot set the mode of this file ({})", file.string(), std::strerror(errno));
}

/// Replaces `path` by a new file with the mode and owner of the file `earlier`, if there is one.
Status replace_like(const std::filesystem::path& path, std::string_view bytes,
                    const std::filesystem::path& earlier) {
  std::filesystem::path draft = path;
  draft += ".new";
  if (Status status = write_file(draft, bytes); !status) return status;
  if (Status status = take_mode_and_owner(draft, earlier); !status) return status;
  if (Status status = flush_to_disk(draft, O_RDONLY); !status) return status;
  std::error_code error;
  std::filesystem::rename(draft, path, error);
  if (error) return fail("{}: cannot replace this file ({})", path.string(), error.message());
  return flush_to_disk(folder_of(path), O_RDONLY | O_DIRECTORY);
}

std::filesystem::path free_backup_of(const std::filesystem::path& path) {
  std::filesystem::path backup = path;
  backup += ".bak";
  std::error_code error;
  for (int number = 2; std::filesystem::exists(backup, error); ++number) {
    backup = path;
    backup += fmt::format(".bak{}", number);
  }
  return backup;
}

}  // namespace

Status check_file_or_none(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status found = std::filesystem::status(path, error);
  if (!std::filesystem::exists(found) || std::filesystem::is_regular_file(found)) return {};
  return fail("{}: found a folder or a device, wanted a file to replace, or none", path.string());
}

Status replace_file(const std::filesystem::path& path, std::string_view bytes) {
  if (Status status = check_file_or_none(path); !status) return status;
  return replace_like(path, bytes, path);
}

Status replace_file_with_backup(const std::filesystem::path& path, std::string_view bytes) {
  if (Status status = check_file_or_none(path); !status) return status;
  std::error_code error;
  if (std::filesystem::exists(path, error)) {
    const Result<std::string> earlier = read_file(path);
    if (!earlier) return tl::unexpected(earlier.error());
    if (Status status = replace_like(free_backup_of(path), *earlier, path); !status) return status;
  }
  return replace_file(path, bytes);
}

}  // namespace bevloc
