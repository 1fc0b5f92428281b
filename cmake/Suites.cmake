# Makes each suite of a GoogleTest program a CTest test named PROGRAM.SUITE. CTest reads this file
# before it runs; bevloc_test() in Targets.cmake includes it with `name`, `timeout_s` and `command`
# set.
execute_process(COMMAND ${command} --gtest_list_tests OUTPUT_VARIABLE listed RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  add_test(${name}.not_built ${command} --gtest_list_tests)
  return()
endif()
# The line of a suite begins in the first column. A dot ends its name, and a comment may follow.
string(REGEX MATCHALL "(^|\n)[A-Za-z][A-Za-z0-9_/]*\\." lines "${listed}")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^\n|\\.$" "" suite "${line}")
  add_test(${name}.${suite} ${command} "--gtest_filter=${suite}.*")
  set_tests_properties(${name}.${suite} PROPERTIES TIMEOUT ${timeout_s})
endforeach()
