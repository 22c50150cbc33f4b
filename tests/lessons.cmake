# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_lessons)
list(APPEND TREPHINE_TEST_AT_ONCE lessons)
trephine_test(lessons lessons)
endif()
if(TARGET trephine-sim AND TARGET trephine)
foreach(script lesson exercise decisions spine_needle two_hands two_hands_lesson)
add_test(NAME program.${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
set_tests_properties(program.${script} PROPERTIES TIMEOUT 1800
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;OFFLINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endforeach()
add_test(NAME program.LongExercises COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/exercises_long.sh)
set_tests_properties(program.LongExercises PROPERTIES TIMEOUT 3600
  ENVIRONMENT "SIM=$<TARGET_FILE:trephine-sim>;TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR}")
endif()
