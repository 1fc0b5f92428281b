#include "sim/faults/fault_text.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "common/cameras.h"
#include "common/number_text.h"
#include "sim/faults/fault_table.h"

namespace bevloc::sim {
namespace {

/// The words KEY=VALUE of a fault. Each is taken once.
class Words {
 public:
  static Result<Words> split(std::istringstream& stream) {
    Words words;
    for (std::string word; stream >> word;) {
      const size_t equals = word.find('=');
      if (equals == std::string::npos) return fail("found {}, wanted KEY=VALUE", word);
      words.words_.push_back({word.substr(0, equals), word.substr(equals + 1)});
    }
    return words;
  }

  std::optional<std::string> take(std::string_view key) {
    const auto found = std::ranges::find(words_, key, &Word::key);
    if (found == words_.end()) return std::nullopt;
    std::string value = std::move(found->value);
    words_.erase(found);
    return value;
  }

  /// The key of a word that was not taken, or "" if there is none.
  std::string left_over() const { return words_.empty() ? "" : words_.front().key; }

 private:
  struct Word {
    std::string key;
    std::string value;
  };
  std::vector<Word> words_;
};

Status take_number(Words& words, std::string_view key, double low, double high, double& number) {
  const auto text = words.take(key);
  if (!text) return {};
  const auto read = parse_number<double>(*text);
  if (!(read >= low && read <= high)) {
    return fail("{}: found {}, wanted a number, {} to {}", key, *text, low, high);
  }
  number = *read;
  return {};
}

Status take_camera(Words& words, std::string_view key, std::optional<int>& camera) {
  const auto name = words.take(key);
  if (!name) return {};
  const auto found = std::ranges::find(kCameraNames, *name);
  if (found == kCameraNames.end()) {
    return fail("{}: found {}, wanted one of {}", key, *name, fmt::join(kCameraNames, ", "));
  }
  camera = static_cast<int>(found - kCameraNames.begin());
  return {};
}

Status take_times(Words& words, double now_s, Fault& fault) {
  constexpr double kLongest_s = 1e9;
  fault.from_s = now_s;
  if (Status read = take_number(words, "from_s", 0.0, kLongest_s, fault.from_s); !read) return read;
  double for_s = -1.0;
  if (Status read = take_number(words, "for_s", 0.0, kLongest_s, for_s); !read) return read;
  if (for_s >= 0.0) {
    fault.until_s = fault.from_s + for_s;
    return {};  // a given until_s is left over, and so refused
  }
  return take_number(words, "until_s", fault.from_s, kLongest_s, fault.until_s);
}

Status take_cameras(Words& words, Fault& fault) {
  const bool of_camera = info_of(fault.kind).input == FaultInput::kCamera;
  if (!of_camera && fault.kind != FaultKind::kHangCapture) return {};
  if (Status read = take_camera(words, "camera", fault.camera); !read) return read;
  if (fault.kind != FaultKind::kCameraSwapped) return {};
  if (Status read = take_camera(words, "with", fault.other_camera); !read) return read;
  if (!fault.camera || !fault.other_camera || fault.camera == fault.other_camera) {
    return fail(
        "camera_swapped: found one camera or none, wanted two cameras: camera=NAME with=NAME");
  }
  return {};
}

Status take_amounts(Words& words, Fault& fault) {
  for (const AmountInfo& amount : info_of(fault.kind).amounts) {
    double value = amount.fallback.value_or(std::nan(""));
    if (Status read = take_number(words, amount.key, amount.low, amount.high, value); !read) {
      return read;
    }
    if (std::isnan(value)) {
      return fail("{}: found no {}, wanted {}=NUMBER, {} to {}", info_of(fault.kind).name,
                  amount.key, amount.key, amount.low, amount.high);
    }
    if (amount.whole && value != std::floor(value)) {
      return fail("{}: found {}, wanted a whole number", amount.key, value);
    }
    fault.amounts.*amount.member = value;
  }
  return {};
}

}  // namespace

Result<Fault> parse_fault(std::string_view text, double now_s) {
  std::istringstream stream{std::string(text)};
  std::string name;
  stream >> name;
  const auto kind = std::ranges::find(fault_kinds(), name, &FaultKindInfo::name);
  if (kind == fault_kinds().end()) {
    std::vector<std::string_view> names;
    for (const FaultKindInfo& info : fault_kinds()) names.push_back(info.name);
    return fail("found '{}', wanted a kind of fault: {}", name, fmt::join(names, ", "));
  }
  auto words = Words::split(stream);
  if (!words) return tl::unexpected(words.error());
  Fault fault = make_fault(kind->kind);
  if (Status read = take_times(*words, now_s, fault); !read) return tl::unexpected(read.error());
  if (Status read = take_cameras(*words, fault); !read) return tl::unexpected(read.error());
  if (Status read = take_amounts(*words, fault); !read) return tl::unexpected(read.error());
  if (!words->left_over().empty()) {
    return fail("{}: found {}, wanted the keys of this kind (docs/simulation.md)", name,
                words->left_over());
  }
  return fault;
}

std::string to_text(const Fault& fault) {
  const FaultKindInfo& info = info_of(fault.kind);
  std::string text = fmt::format("{} from_s={}", info.name, fault.from_s);
  if (std::isfinite(fault.until_s)) text += fmt::format(" until_s={}", fault.until_s);
  if (fault.camera) text += fmt::format(" camera={}", kCameraNames[*fault.camera]);
  if (fault.other_camera) text += fmt::format(" with={}", kCameraNames[*fault.other_camera]);
  for (const AmountInfo& amount : info.amounts) {
    text += fmt::format(" {}={}", amount.key, fault.amounts.*amount.member);
  }
  return text;
}

}  // namespace bevloc::sim
