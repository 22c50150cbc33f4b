# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_group)
trephine_test(group group)
endif()
if(TARGET trephine-sim AND TARGET trephine)
foreach(script group questionnaire)
add_test(NAME program.${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
set_tests_properties(program.${script} PROPERTIES TIMEOUT 1800
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;OFFLINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endforeach()
endif()
