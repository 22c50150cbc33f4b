# SPDX-License-Identifier: GPL-3.0-or-later
list(APPEND TREPHINE_TEST_AT_ONCE outcome)
trephine_test(outcome outcome phantom)
if(TARGET trephine AND TARGET trephine-sim)
  add_test(NAME program.outcome COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/outcome.sh)
  add_test(NAME program.outcome_screws COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/outcome_screws.sh)
  add_test(NAME program.outcome_line COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/outcome_line.sh)
  set_tests_properties(program.outcome program.outcome_screws program.outcome_line PROPERTIES TIMEOUT 1800
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SIM=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR}")
endif()
