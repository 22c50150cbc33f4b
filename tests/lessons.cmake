# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_lessons)
trephine_test(lessons lessons)
endif()
if(TARGET trephine-sim AND TARGET trephine)
add_test(NAME program.lesson COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/lesson.sh)
set_tests_properties(program.lesson PROPERTIES TIMEOUT 300
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;OFFLINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endif()
