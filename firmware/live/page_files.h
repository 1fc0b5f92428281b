// The files of the live page, which CMake puts into the program (firmware/live/page).
#pragma once

#include <string_view>

namespace bevloc::firmware {

std::string_view page_html();
std::string_view page_css();
std::string_view page_js();

}  // namespace bevloc::firmware
