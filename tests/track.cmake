# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_lessons)
# Messages are made by the library's own classes.
trephine_test(track lessons)
target_link_libraries(track_test PRIVATE ${TREPHINE_OPENIGTLINK})
target_include_directories(track_test SYSTEM PRIVATE /usr/include/openigtlink)
endif()
if(TARGET trephine-sim AND TARGET trephine)
add_executable(track_fake_server track_fake_server.cpp)
target_link_libraries(track_fake_server PRIVATE trephine_lessons ${TREPHINE_OPENIGTLINK})
target_include_directories(track_fake_server SYSTEM PRIVATE /usr/include/openigtlink)
foreach(script track track_lesson)
add_test(NAME program.${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
set_tests_properties(program.${script} PROPERTIES TIMEOUT 1800 SKIP_RETURN_CODE 77
  ENVIRONMENT "OFFLINE=$<TARGET_FILE:trephine>;TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case;SERVER=$<TARGET_FILE:track_fake_server>")
endforeach()
endif()
