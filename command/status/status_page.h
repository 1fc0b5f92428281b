// The page that `bevloc status` prints.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace bevloc::command {

/// Makes the page from /status.json of a daemon. A missing key is shown as "-", because the daemon
/// may have another version.
std::string status_page(const nlohmann::json& status);

}  // namespace bevloc::command
