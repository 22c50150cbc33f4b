# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_lessons)
# Messages are made by the library's own classes.
trephine_test(track lessons)
target_link_libraries(track_test PRIVATE ${TREPHINE_OPENIGTLINK})
target_include_directories(track_test SYSTEM PRIVATE /usr/include/openigtlink)
endif()
if(TARGET trephine-sim)
add_executable(track_fake_server track_fake_server.cpp)
target_link_libraries(track_fake_server PRIVATE trephine_lessons ${TREPHINE_OPENIGTLINK})
target_include_directories(track_fake_server SYSTEM PRIVATE /usr/include/openigtlink)
add_test(NAME program.track COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/track.sh)
set_tests_properties(program.track PROPERTIES TIMEOUT 1800
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case;SERVER=$<TARGET_FILE:track_fake_server>")
endif()
