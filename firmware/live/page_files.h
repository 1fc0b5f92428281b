// The files of the live page, which CMake puts into the program (firmware/live/page).
#pragma once

#include <span>
#include <string_view>

namespace bevloc::firmware {

struct PageFile {
  std::string_view path;  ///< at the server, such as "/page.css"; "/page.html" is the page itself
  std::string_view text;
};

std::span<const PageFile> page_files();

}  // namespace bevloc::firmware
