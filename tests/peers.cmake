# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine_peers)
trephine_test(peers peers)
add_library(peer_stub MODULE peer_stub.c)
set_target_properties(peer_stub PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
target_include_directories(peer_stub PRIVATE ${PROJECT_SOURCE_DIR}/simulator)
target_compile_definitions(peers_test PRIVATE PEER_STUB="$<TARGET_FILE:peer_stub>")
# The example for CHAI3D is compiled against declarations, for Debian has no CHAI3D.
add_library(chai3d_peer_compiles OBJECT ${PROJECT_SOURCE_DIR}/examples/chai3d_peer/chai3d_peer.cpp)
target_include_directories(chai3d_peer_compiles PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/chai3d_declarations ${PROJECT_SOURCE_DIR}/simulator/peers)
add_dependencies(peers_test peer_stub chai3d_peer_compiles)
add_test(NAME program.compare COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/compare.sh)
set_tests_properties(program.compare PROPERTIES TIMEOUT 1800
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case;PEER_STUB=$<TARGET_FILE:peer_stub>")
endif()
