# Builds for arm64 on an amd64 machine that has Debian's cross compiler and the arm64 libraries
# (script/package makes such a root). Set this variable, so that every CMake run of a build uses this
# file:
#   CMAKE_TOOLCHAIN_FILE=$PWD/cmake/arm64.cmake script/build vehicle
# qemu runs the programs that the build and the tests need.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(PKG_CONFIG_EXECUTABLE aarch64-linux-gnu-pkg-config)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64)
