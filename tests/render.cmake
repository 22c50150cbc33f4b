# SPDX-License-Identifier: GPL-3.0-or-later
# Pictures of the simulator, drawn without a display by Mesa's llvmpipe with one thread.
if(TARGET trephine_render)
trephine_test(render render picture)
endif()
if(TARGET trephine_window)
trephine_test(window window)
add_library(reset_stub MODULE reset_stub.c)
set_target_properties(reset_stub PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
foreach(script render play play_faults)
  add_test(NAME program.${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
  set_tests_properties(program.${script} PROPERTIES TIMEOUT 1800 SKIP_RETURN_CODE 77
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case;STUB=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/adaptor_stub.so;PAD_STUB=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/gamepad_stub.so;RESET_STUB=$<TARGET_FILE:reset_stub>")
endforeach()
if(TARGET trephine)
foreach(which play_lesson:0:play_lesson LongPlayLesson:1:play_lesson play_spine:0:play_spine)
string(REPLACE ":" ";" which ${which})
list(GET which 0 name)
list(GET which 1 long)
list(GET which 2 script)
add_test(NAME program.${name} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
set_tests_properties(program.${name} PROPERTIES TIMEOUT 1800 SKIP_RETURN_CODE 77
  ENVIRONMENT "LONG=${long};TREPHINE=$<TARGET_FILE:trephine-sim>;OFFLINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endforeach()
endif()
add_test(NAME program.LongPlay COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/play_long.sh)
set_tests_properties(program.LongPlay PROPERTIES TIMEOUT 4500 SKIP_RETURN_CODE 77
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endif()
