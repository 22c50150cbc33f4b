# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_study)
trephine_test(study study)
endif()
if(TARGET trephine-sim)
add_test(NAME program.study COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/study.sh)
set_tests_properties(program.study PROPERTIES TIMEOUT 600 SKIP_RETURN_CODE 77
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR}")
endif()
if(TARGET trephine-sim AND TARGET write_sample_case)
add_test(NAME program.export_recording COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/export_recording.sh)
set_tests_properties(program.export_recording PROPERTIES TIMEOUT 600
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=$<TARGET_FILE:write_sample_case>")
endif()
