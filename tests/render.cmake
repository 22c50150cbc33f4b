# SPDX-License-Identifier: GPL-3.0-or-later
# Pictures of the simulator, drawn without a display by Mesa's llvmpipe with one thread.
if(TARGET trephine_render)
trephine_test(render render picture)
endif()
if(TARGET trephine_window)
foreach(script render play)
  add_test(NAME program.${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
  set_tests_properties(program.${script} PROPERTIES TIMEOUT 300 SKIP_RETURN_CODE 77
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endforeach()
if(TARGET trephine)
foreach(which play_lesson:0 LongPlayLesson:1)
string(REPLACE ":" ";" which ${which})
list(GET which 0 name)
list(GET which 1 long)
add_test(NAME program.${name} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/play_lesson.sh)
set_tests_properties(program.${name} PROPERTIES TIMEOUT 900 SKIP_RETURN_CODE 77
  ENVIRONMENT "LONG=${long};TREPHINE=$<TARGET_FILE:trephine-sim>;OFFLINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endforeach()
endif()
add_test(NAME program.LongPlay COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/play_long.sh)
set_tests_properties(program.LongPlay PROPERTIES TIMEOUT 4500 SKIP_RETURN_CODE 77
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endif()
