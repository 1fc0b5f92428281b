#include "drivers/gpio/line_lookup.h"

#include <algorithm>
#include <optional>

#include "common/number_text.h"

namespace bevloc::drivers {
namespace {

std::string list_of(const std::vector<GpioChipInfo>& chips) {
  if (chips.empty()) return "none";
  std::string list;
  for (const GpioChipInfo& chip : chips) {
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", chip.name, chip.label);
  }
  return list;
}

Result<size_t> find_chip(const std::vector<GpioChipInfo>& chips, const LineAddress& address) {
  const auto is_meant = [&address](const GpioChipInfo& chip) {
    return chip.name == address.chip || chip.label == address.chip;
  };
  const auto chip = std::ranges::find_if(chips, is_meant);
  if (chip == chips.end()) {
    return fail("{}: found no such GPIO chip; available: {}", to_string(address), list_of(chips));
  }
  if (std::ranges::count_if(chips, is_meant) > 1) {
    return fail("{}: found more than one GPIO chip with this label, wanted a chip's name: {}",
                to_string(address), list_of(chips));
  }
  return static_cast<size_t>(chip - chips.begin());
}

Result<unsigned> find_line_on(const GpioChipInfo& chip, const LineAddress& address) {
  const auto named = std::ranges::find(chip.lines, address.line, &GpioLineInfo::name);
  if (named != chip.lines.end()) {
    if (std::ranges::count(chip.lines, address.line, &GpioLineInfo::name) > 1) {
      return fail("{}: found more than one line with this name, wanted the line's number",
                  to_string(address));
    }
    return static_cast<unsigned>(named - chip.lines.begin());
  }
  const auto number = parse_number<unsigned>(address.line);
  if (!number || *number >= chip.lines.size()) {
    return fail("{}: found no such line on {}, wanted a line's name or 0 to {}", to_string(address),
                chip.name, static_cast<int>(chip.lines.size()) - 1);
  }
  return *number;
}

}  // namespace

std::string to_string(const LineAddress& address) {
  return address.chip + " " + address.line;
}

Result<GpioLinePlace> find_line(const std::vector<GpioChipInfo>& chips,
                                const LineAddress& address) {
  const auto chip = find_chip(chips, address);
  if (!chip) return tl::unexpected(chip.error());
  const auto line = find_line_on(chips[*chip], address);
  if (!line) return tl::unexpected(line.error());
  return GpioLinePlace{*chip, *line};
}

Result<GpioLinePlace> find_free_line(const std::vector<GpioChipInfo>& chips,
                                     const LineAddress& address) {
  const auto place = find_line(chips, address);
  if (!place) return place;
  const std::string& consumer = chips[place->chip].lines[place->line].consumer;
  if (!consumer.empty()) {
    return fail("{}: found a line that \"{}\" uses, wanted a free one", to_string(address),
                consumer);
  }
  return place;
}

}  // namespace bevloc::drivers
