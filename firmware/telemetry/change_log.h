// Decides which changes of a value are logged, so that a value that alternates does not fill the
// log.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "firmware/telemetry/cause_log.h"

namespace bevloc::firmware {

enum class ChangeKind : uint8_t {
  kMayAlternate,  ///< may occur many times a second, so it is logged once per cause
  kImportant,     ///< is always logged
};

/// Follows one value, such as a state. A change that may alternate is logged if it is a new cause
/// (CauseLog), and otherwise when the new value has lasted for CauseLog::kLasting. So a value that
/// alternates costs few lines, and the latest line names the value that stayed. One thread.
class ChangeLog {
 public:
  /// `value` is the value before the first note().
  explicit ChangeLog(std::string value) : value_(std::move(value)) {}

  /// Notes the value at `now`. `why` has its reasons; the same change for other reasons is another
  /// cause. Returns the text "OLD -> NEW: REASONS" if a line is due. The text also says how many
  /// changes there were since the previous line, if there were several.
  std::optional<std::string> note(std::string_view value, std::string_view why, ChangeKind kind,
                                  Time now) {
    const bool changed = value != value_;
    if (changed) {
      change_ = fmt::format("{} -> {}", value_, value);
      value_ = value;
      since_ = now;
      ++untold_;
    } else if (untold_ == 0 || now - since_ < CauseLog::kLasting) {
      return std::nullopt;
    }
    std::string text = fmt::format("{}{}{}", change_, why.empty() ? "" : ": ", why);
    if (changed && kind == ChangeKind::kMayAlternate && !causes_.is_new(text, now)) {
      return std::nullopt;
    }
    if (untold_ > 1) {
      text += fmt::format(" (the latest of {} changes since the previous line)", untold_);
    }
    untold_ = 0;
    return text;
  }

 private:
  std::string value_;
  std::string change_;   ///< the latest change
  Time since_{};         ///< its time
  uint64_t untold_ = 0;  ///< number of changes since the latest line
  CauseLog causes_;
};

}  // namespace bevloc::firmware
