# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine-sim)
foreach(script servo servo_udp)
add_test(NAME program.${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
set_tests_properties(program.${script} PROPERTIES TIMEOUT 300
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endforeach()
add_test(NAME program.flags_sim COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/flags.sh)
set_tests_properties(program.flags_sim PROPERTIES TIMEOUT 300
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR}")
endif()
