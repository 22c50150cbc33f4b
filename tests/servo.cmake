# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine-sim)
add_test(NAME program.servo COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/servo.sh)
set_tests_properties(program.servo PROPERTIES TIMEOUT 300
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endif()
