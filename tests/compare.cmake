# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(compare compare)
target_link_libraries(compare_test PRIVATE nlohmann_json::nlohmann_json)
if(TARGET trephine AND NOT TREPHINE_HEADLESS)
add_test(NAME program.diff COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/diff.sh)
set_tests_properties(program.diff PROPERTIES TIMEOUT 1800 SKIP_RETURN_CODE 77
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=$<TARGET_FILE:write_sample_case>")
endif()
