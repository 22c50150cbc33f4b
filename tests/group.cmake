# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_group)
trephine_test(group group)
endif()
if(TARGET trephine-sim AND TARGET trephine)
# A group of twelve is one of the long suites; group_test and program.exercise are its small cases.
foreach(script long_group questionnaire)
string(REPLACE long_ Long test ${script})
add_test(NAME program.${test} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
set_tests_properties(program.${test} PROPERTIES TIMEOUT 1800
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;OFFLINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endforeach()
endif()
