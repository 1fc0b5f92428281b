#include "drivers/camera/v4l2/controls.h"

#include <cctype>
#include <cerrno>
#include <cstring>
#include <optional>
#include <vector>

#include <linux/videodev2.h>

#include "common/number_text.h"

namespace bevloc::drivers::v4l2 {
namespace {

std::vector<v4l2_query_ext_ctrl> controls_of(const Device& device) {
  constexpr uint32_t kNext = V4L2_CTRL_FLAG_NEXT_CTRL;
  std::vector<v4l2_query_ext_ctrl> controls;
  v4l2_query_ext_ctrl control{};
  for (control.id = kNext; device.call(VIDIOC_QUERY_EXT_CTRL, &control) == 0; control.id |= kNext) {
    const bool is_value =
        control.type == V4L2_CTRL_TYPE_INTEGER || control.type == V4L2_CTRL_TYPE_INTEGER64 ||
        control.type == V4L2_CTRL_TYPE_BOOLEAN || control.type == V4L2_CTRL_TYPE_MENU ||
        control.type == V4L2_CTRL_TYPE_INTEGER_MENU;
    if (is_value && (control.flags & V4L2_CTRL_FLAG_DISABLED) == 0) controls.push_back(control);
  }
  return controls;
}

std::optional<uint32_t> id_in(std::string_view name) {
  constexpr int kHexadecimal = 16;
  if (!name.starts_with("0x")) return std::nullopt;
  return parse_number<uint32_t>(name.substr(2), kHexadecimal);
}

const v4l2_query_ext_ctrl* find(const std::vector<v4l2_query_ext_ctrl>& controls,
                                const std::string& name) {
  const auto id = id_in(name);
  for (const v4l2_query_ext_ctrl& control : controls) {
    if (id ? control.id == *id : control_word(control.name) == name) return &control;
  }
  return nullptr;
}

Status set(const Device& device, const v4l2_query_ext_ctrl& control, double wanted) {
  const auto value = static_cast<int64_t>(wanted);
  const std::string word = control_word(control.name);
  if (static_cast<double>(value) != wanted || value < control.minimum || value > control.maximum) {
    return fail("{}: control {} is {}, wanted a whole number, {} to {}", device.name(), word,
                wanted, control.minimum, control.maximum);
  }
  v4l2_ext_control setting{};
  setting.id = control.id;
  if (control.type == V4L2_CTRL_TYPE_INTEGER64) {
    setting.value64 = value;
  } else {
    setting.value = static_cast<int32_t>(value);
  }
  v4l2_ext_controls settings{};
  settings.which = V4L2_CTRL_WHICH_CUR_VAL;
  settings.count = 1;
  settings.controls = &setting;
  if (const int error = device.call(VIDIOC_S_EXT_CTRLS, &settings)) {
    return fail("{}: control {} cannot be set to {}: {}", device.name(), word, value,
                std::strerror(error));
  }
  return {};
}

}  // namespace

std::string control_word(std::string_view name) {
  std::string word;
  bool after_separator = false;
  for (const char character : name) {
    const auto letter = static_cast<unsigned char>(character);
    if (std::isalnum(letter) == 0) {
      after_separator = true;
      continue;
    }
    if (after_separator && !word.empty()) word.push_back('_');
    after_separator = false;
    word.push_back(static_cast<char>(std::tolower(letter)));
  }
  return word;
}

Status set_controls(const Device& device, std::span<const ControlSetting> settings,
                    uint32_t flags) {
  if (settings.empty()) return {};
  const std::vector<v4l2_query_ext_ctrl> controls = controls_of(device);
  for (const ControlSetting& setting : settings) {
    const v4l2_query_ext_ctrl* control = find(controls, setting.name);
    if (control == nullptr) {
      std::vector<std::string> words;
      for (const v4l2_query_ext_ctrl& known : controls) words.push_back(control_word(known.name));
      return fail("{}: has no control {}; it has {}", device.name(), setting.name,
                  words.empty() ? "none" : fmt::format("{}", fmt::join(words, ", ")));
    }
    if ((control->flags & flags) != flags) continue;
    if (Status done = set(device, *control, setting.value); !done) return done;
  }
  return {};
}

}  // namespace bevloc::drivers::v4l2
