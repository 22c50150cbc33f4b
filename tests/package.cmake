# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET manual)
foreach(which deb:0:deb Long_deb:1:deb_case)
string(REPLACE ":" ";" which ${which})
list(GET which 0 name)
list(GET which 1 long)
list(GET which 2 script)
add_test(NAME program.${name} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
set_tests_properties(program.${name} PROPERTIES TIMEOUT 1800 SKIP_RETURN_CODE 77
  ENVIRONMENT "LONG=${long};TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};BUILD=${PROJECT_BINARY_DIR};COMPILED_HARDENED=1;FORTIFIED=$<CONFIG:Release,RelWithDebInfo,MinSizeRel>")
endforeach()
endif()
