# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(ambf ambf)
if(TARGET trephine AND TARGET trephine-sim)
  add_test(NAME program.ambf_stack COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/ambf_stack.sh)
  set_tests_properties(program.ambf_stack PROPERTIES TIMEOUT 1800 SKIP_RETURN_CODE 77
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SIM=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endif()
