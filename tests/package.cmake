# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET manual)
add_test(NAME program.deb COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/deb.sh)
set_tests_properties(program.deb PROPERTIES TIMEOUT 900 SKIP_RETURN_CODE 77
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};BUILD=${PROJECT_BINARY_DIR}")
endif()
