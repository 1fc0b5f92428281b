# Hardening: what makes a bug harder to exploit (script/check-hardening checks a program for it). All
# release builds have it, so that the tests run what vehicles run. Sanitizers have stronger checks of
# their own, and debug builds do without.
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT BEVLOC_SANITIZE)
  include(CheckPIESupported)
  check_pie_supported()
  target_link_options(bevloc_options INTERFACE -Wl,-z,relro,-z,now,-z,noexecstack)
  target_compile_options(bevloc_options INTERFACE
    -fstack-protector-strong -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2
    -Wformat -Wformat-security -Werror=format-security)
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    target_compile_options(bevloc_options INTERFACE -fcf-protection=full)
  elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
    target_compile_options(bevloc_options INTERFACE -mbranch-protection=standard)
  endif()
endif()
