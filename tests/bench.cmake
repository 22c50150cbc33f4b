# SPDX-License-Identifier: GPL-3.0-or-later
# bench/guard with stand-ins for the programs.
add_test(NAME bench.guard COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/guard.sh ${PROJECT_SOURCE_DIR})
# The five works whose instructions are counted; they end where they should on every machine, and the count is for the long suites.
add_executable(guard_works guard_works.cpp)
target_link_libraries(guard_works PRIVATE trephine_segmentation trephine_meshing trephine_voxel trephine_picture)
add_test(NAME bench.LongInstructions
  COMMAND ${PROJECT_SOURCE_DIR}/bench/guard --instructions $<TARGET_FILE:guard_works> ${PROJECT_SOURCE_DIR}/bench/guard_base.json)
set_tests_properties(bench.LongInstructions PROPERTIES TIMEOUT 3600 SKIP_RETURN_CODE 77)
