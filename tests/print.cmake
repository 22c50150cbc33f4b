# SPDX-License-Identifier: GPL-3.0-or-later
list(APPEND TREPHINE_TEST_AT_ONCE print)
trephine_test(print print phantom)
if(TARGET trephine AND TARGET trephine-sim)
  add_test(NAME program.LongPrint COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/print.sh)
  set_tests_properties(program.LongPrint PROPERTIES TIMEOUT 3600 SKIP_RETURN_CODE 77
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SIM=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR}")
endif()
