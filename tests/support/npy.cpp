#include "tests/support/npy.h"

#include <bit>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <numeric>
#include <regex>
#include <stdexcept>

#include <Eigen/Core>

namespace bevloc::test {
namespace {

static_assert(std::endian::native == std::endian::little, "the files are little-endian");

struct RawArray {
  std::string type;  ///< numpy's name, as "<f4"
  std::vector<size_t> shape;
  std::string bytes;

  size_t count() const {
    return std::accumulate(shape.begin(), shape.end(), size_t{1}, std::multiplies<>());
  }
};

/// Format version 1.0: magic, version, length of the header, the header (a Python dict), elements.
RawArray read_raw(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(file), {}};
  constexpr size_t kPreamble = 10;
  if (content.size() < kPreamble || !content.starts_with("\x93NUMPY\x01")) {
    throw std::runtime_error(path + ": not a .npy file of version 1");
  }
  uint16_t header_size = 0;
  std::memcpy(&header_size, content.data() + 8, sizeof(header_size));
  const std::string header = content.substr(kPreamble, header_size);
  std::smatch match;
  static const std::regex kHeader(
      R"('descr': '([^']*)', 'fortran_order': False, 'shape': \(([0-9, ]*)\))");
  if (!std::regex_search(header, match, kHeader)) {
    throw std::runtime_error(path + ": not a row-major array: " + header);
  }
  RawArray array{match[1], {}, content.substr(kPreamble + header_size)};
  const std::string shape = match[2];
  static const std::regex kNumber("[0-9]+");
  for (std::sregex_iterator i(shape.begin(), shape.end(), kNumber), end; i != end; ++i) {
    array.shape.push_back(std::stoul(i->str()));
  }
  return array;
}

template <typename Stored, typename Element>
NpyArray<Element> elements_of(const RawArray& raw, const std::string& path) {
  std::vector<Stored> stored(raw.count());
  if (raw.bytes.size() != stored.size() * sizeof(Stored)) {
    throw std::runtime_error(path + ": its size does not fit its shape");
  }
  std::memcpy(stored.data(), raw.bytes.data(), raw.bytes.size());
  NpyArray<Element> array{raw.shape, {}};
  array.values.reserve(stored.size());
  for (const Stored value : stored) array.values.push_back(static_cast<Element>(value));
  return array;
}

}  // namespace

NpyArray<float> read_npy_floats(const std::string& path) {
  const RawArray raw = read_raw(path);
  if (raw.type == "<f4") return elements_of<float, float>(raw, path);
  if (raw.type == "<f2") return elements_of<Eigen::half, float>(raw, path);
  throw std::runtime_error(path + ": elements are " + raw.type + ", wanted <f4 or <f2");
}

NpyArray<uint8_t> read_npy_bytes(const std::string& path) {
  const RawArray raw = read_raw(path);
  if (raw.type != "|u1") {
    throw std::runtime_error(path + ": elements are " + raw.type + ", wanted |u1");
  }
  return elements_of<uint8_t, uint8_t>(raw, path);
}

std::string golden(const std::string& file) {
  return std::string(BEVLOC_SOURCE_DIR "/tests/golden/") + file;
}

}  // namespace bevloc::test
