#include "can/secoc/secoc_files.h"

#include <cerrno>
#include <string>
#include <system_error>

#include <sys/stat.h>

#include "common/files.h"
#include "common/number_text.h"
#include "common/replace_file.h"

namespace bevloc::can {
namespace {

std::string cause(int error) {
  return std::generic_category().message(error);
}

std::string without_end_of_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text;
}

}  // namespace

Result<SecocKey> read_secoc_key(const std::filesystem::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) {
    return fail("{}: cannot be read ({}), wanted a key of 32 hexadecimal digits", file.string(),
                cause(errno));
  }
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    return fail("{}: found permissions {:04o}, wanted 0600 or 0400: `chmod 600 {}`", file.string(),
                status.st_mode & 07777, file.string());
  }
  auto content = read_file(file);
  if (!content) return tl::unexpected(content.error());
  const std::string digits = without_end_of_line(std::move(*content));
  SecocKey key{};
  for (size_t i = 0; i < key.size(); ++i) {
    const bool long_enough = digits.size() == 2 * key.size();
    const auto byte =
        long_enough ? parse_number<uint8_t>({digits.data() + 2 * i, 2}, 16) : std::nullopt;
    if (!byte) {
      return fail("{}: found {} characters or others than hexadecimal digits, wanted 32 digits",
                  file.string(), digits.size());
    }
    key[i] = *byte;
  }
  return key;
}

Result<uint32_t> read_start_number(const std::filesystem::path& file) {
  std::error_code error;
  const bool exists = std::filesystem::exists(file, error);
  // Only if there surely is no file, counting begins anew.
  if (error) {
    return fail("{}: cannot be read ({}), wanted the number of starts or no file", file.string(),
                error.message());
  }
  if (!exists) return 0;
  auto content = read_file(file);
  if (!content) return tl::unexpected(content.error());
  const std::string text = without_end_of_line(std::move(*content));
  const auto number = parse_number<uint32_t>(text);
  if (!number || *number == UINT32_MAX) {
    // The content stays out of the log: it may be the key, if the configuration mixes up the files.
    return fail(
        "{}: found {} bytes that are no number of starts, wanted one whole number; write a number "
        "larger than every number before; a smaller one makes the vehicle refuse all messages",
        file.string(), text.size());
  }
  return *number;
}

Result<uint32_t> next_start_number(const std::filesystem::path& file) {
  const Result<uint32_t> last = read_start_number(file);
  if (!last) return last;
  const uint32_t number = *last + 1;
  if (Status written = replace_file(file, fmt::format("{}\n", number)); !written) {
    return fail(
        "{}: the number of starts cannot be written ({}), wanted a folder that bevlocd may "
        "write, such as /var/lib/bevloc",
        file.string(), written.error().message);
  }
  return number;
}

}  // namespace bevloc::can
