# SPDX-License-Identifier: MIT
#
# Writes to OUTPUT what ctest shall run of PROGRAM: one test for each suite, whatever its types and parameters, without
# the tests that match LONGEST, and the suites whose names match ACCURACY once more for each of TARGETS, without the tests
# that match LEFT_OUT. EMULATOR runs PROGRAM, if it is not empty.
execute_process(COMMAND ${EMULATOR} ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "\n[^ \n]+\\." suites "\n${listed}")
list(TRANSFORM suites STRIP)
list(TRANSFORM suites REPLACE "(/[0-9]+)?\\.$" "")
list(REMOVE_DUPLICATES suites)

set(tests)
set(seconds 600)
if(EMULATOR)
  set(seconds 6000)
endif()
function(add_suite name suite left_out properties)
  set(filter "${suite}.*:${suite}/*-${left_out}")
  string(APPEND tests "add_test([[${name}]] ${EMULATOR} [[${PROGRAM}]] --gtest_brief=1 [[--gtest_filter=${filter}]])\n"
    "set_tests_properties([[${name}]] PROPERTIES TIMEOUT ${seconds} ${properties})\n")
  set(tests "${tests}" PARENT_SCOPE)
endfunction()

foreach(suite IN LISTS suites)
  add_suite(${suite} ${suite} "${LONGEST}" "")
  if(suite MATCHES "^(${ACCURACY})$")
    foreach(target IN LISTS TARGETS)
      add_suite(${target}/${suite} ${suite} "${LEFT_OUT}" "ENVIRONMENT SHLIGHT_KERNEL_TARGET=${target}")
    endforeach()
  endif()
endforeach()
file(WRITE ${OUTPUT} "${tests}")
