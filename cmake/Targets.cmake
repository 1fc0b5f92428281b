# How this project builds a library, a program and a test: one definition each.
add_library(bevloc_options INTERFACE)
target_compile_features(bevloc_options INTERFACE cxx_std_20)
target_include_directories(bevloc_options INTERFACE ${PROJECT_SOURCE_DIR})
# Without fused multiplications and additions, which arm64 and newer x86-64 have and others do not,
# all processors compute the same bits (docs/performance.md).
target_compile_options(bevloc_options INTERFACE -ffp-contract=off
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Woverloaded-virtual
  $<$<BOOL:${BEVLOC_WARNINGS_AS_ERRORS}>:-Werror>)
if(BEVLOC_SANITIZE)
  # ubsan does not check for null pointers, because asan stops a program that reads or writes at one,
  # and the check takes a seventh of the compiler's time.
  # Instrumented std::regex makes GCC 12 see uninitialized members (GCC bug 105562).
  target_compile_options(bevloc_options INTERFACE
    -fsanitize=${BEVLOC_SANITIZE} -fno-sanitize=null -fno-sanitize-recover=all -fno-omit-frame-pointer
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(bevloc_options INTERFACE -fsanitize=${BEVLOC_SANITIZE})
endif()
if(BEVLOC_FUZZ)
  target_compile_options(bevloc_options INTERFACE -fsanitize=fuzzer-no-link)
endif()
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
# Compiling with -O3 takes 1.5 times as long as with -O2. Only the FAST libraries below need it.
string(REPLACE "-O3" "-O2" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")

# Several sources of a target are compiled as one, because most of the time goes into headers: the
# whole build then takes less than half of the processor time. Names in unnamed namespaces must
# therefore be unique within a target. An editor's single-file checks want -DBEVLOC_UNITY=OFF.
option(BEVLOC_UNITY "Compile several sources of a target as one" ON)
set(BEVLOC_UNITY_BATCH 40 CACHE STRING "How many sources are compiled as one")
function(bevloc_compile_together name)
  set_target_properties(${name} PROPERTIES
    UNITY_BUILD ${BEVLOC_UNITY} UNITY_BUILD_BATCH_SIZE ${BEVLOC_UNITY_BATCH})
endfunction()

# bevloc_library(NAME SOURCES... [FAST] [LINK libs...])
# FAST compiles with -O3. Libraries with the inner loops need it.
function(bevloc_library name)
  cmake_parse_arguments(ARG "FAST" "" "LINK" ${ARGN})
  add_library(${name} STATIC ${ARG_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PUBLIC bevloc_options ${ARG_LINK})
  if(ARG_FAST)
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O3>)
  endif()
  bevloc_compile_together(${name})
  # The sources for one instruction set use the same names, and two others only compile with GCC.
  list(FILTER ARG_UNPARSED_ARGUMENTS INCLUDE REGEX
    "_(avx2|avxvnni|avx512vnni|dotprod|i8mm|neon|plain)\\.cpp$|^(cell_features|kernels/strip_kernels)\\.cpp$")
  set_source_files_properties(${ARG_UNPARSED_ARGUMENTS} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  if(BEVLOC_FUZZ)
    # clang ignores the pragmas that select their instruction set.
    set_source_files_properties(${ARG_UNPARSED_ARGUMENTS} PROPERTIES COMPILE_OPTIONS
      "-mavx2;-mfma;-mavx512f;-mavx512bw;-mavx512vl;-mavx512vnni;-mavxvnni;-include;${PROJECT_SOURCE_DIR}/tests/fuzz/gcc_builtins.h")
  endif()
endfunction()

# Time limits of tests are multiplied by this factor: qemu needs some 20 times as long as a processor.
set(BEVLOC_TEST_TIME_FACTOR 1)
if(CMAKE_CROSSCOMPILING)
  set(BEVLOC_TEST_TIME_FACTOR 20)
endif()

# bevloc_test(NAME SOURCES... [WHOLE] [FAST] [LINK libs...]): a GoogleTest program. Each of its suites
# is a CTest test. With WHOLE, the program is a single CTest test, because its suites share an expensive
# set-up. With sanitizers every program is a single test, because each start of a program takes long.
# With FAST, the tests' own sources are optimized under sanitizers, too. It is for tests that compute
# much: without it they take three times as long.
function(bevloc_test name)
  cmake_parse_arguments(ARG "WHOLE;FAST" "" "LINK" ${ARGN})
  add_executable(${name} ${ARG_UNPARSED_ARGUMENTS})
  target_link_libraries(${name} PRIVATE bevloc_options ${ARG_LINK} GTest::gmock GTest::gtest_main)
  # The tests' own sources are compiled once and run once, so optimizing them costs more than it gains.
  # ubsan does not check the alignment of pointers in them, which takes a quarter of the compiler's
  # time. It checks the alignment in the sources under test.
  target_compile_options(${name} PRIVATE
    $<$<CONFIG:Release>:-O1> $<$<CONFIG:Sanitize>:-fno-sanitize=alignment>)
  if(NOT ARG_FAST)
    target_compile_options(${name} PRIVATE $<$<CONFIG:Sanitize>:-O0>)
  endif()
  bevloc_compile_together(${name})
  target_compile_definitions(${name} PRIVATE BEVLOC_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  if(ARG_WHOLE OR BEVLOC_SANITIZE)
    add_test(NAME ${name} COMMAND ${name})
    math(EXPR timeout_s "900 * ${BEVLOC_TEST_TIME_FACTOR}")
    set_tests_properties(${name} PROPERTIES TIMEOUT ${timeout_s})
  else()
    set(suites ${CMAKE_CURRENT_BINARY_DIR}/${name}_suites.cmake)
    math(EXPR timeout_s "600 * ${BEVLOC_TEST_TIME_FACTOR}")
    file(GENERATE OUTPUT ${suites}
      CONTENT "set(name ${name})
set(timeout_s ${timeout_s})
set(command ${CMAKE_CROSSCOMPILING_EMULATOR} \"$<TARGET_FILE:${name}>\")
include(\"${PROJECT_SOURCE_DIR}/cmake/Suites.cmake\")
")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${suites})
  endif()
endfunction()

# bevloc_python_test(NAME MODULES... [ENVIRONMENT NAME=VALUE...]): modules of Python tests that run in
# one process, because most of them spend their time on importing PyTorch.
function(bevloc_python_test name)
  cmake_parse_arguments(ARG "" "" "ENVIRONMENT" ${ARGN})
  add_test(NAME ${name} COMMAND /usr/bin/python3 -m unittest ${ARG_UNPARSED_ARGUMENTS}
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES TIMEOUT 600 LABELS python
    ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1;${ARG_ENVIRONMENT}")
endfunction()
