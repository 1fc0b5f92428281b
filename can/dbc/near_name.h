// Finds the name that a misspelt one probably means.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace bevloc::can {

/// Returns the candidate with the fewest letters to insert, remove or replace, without regard to
/// case. Returns nothing if more than a third of the letters differ.
std::optional<std::string> near_name(std::string_view name,
                                     std::span<const std::string> candidates);

}  // namespace bevloc::can
