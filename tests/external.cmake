# SPDX-License-Identifier: GPL-3.0-or-later
add_executable(external_program external_program.cpp)
target_link_libraries(external_program PRIVATE trephine_grid)
trephine_test(external external)
target_compile_definitions(external_test PRIVATE EXTERNAL_PROGRAM="$<TARGET_FILE:external_program>")
add_dependencies(external_test external_program)
if(TARGET trephine)
  add_test(NAME program.external COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/external.sh)
  set_tests_properties(program.external PROPERTIES TIMEOUT 1800
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};LABELLER=$<TARGET_FILE:external_program>")
endif()
if(TARGET trephine)
  add_test(NAME program.Long_external_recipes COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/external_recipes.sh)
  set_tests_properties(program.Long_external_recipes PROPERTIES TIMEOUT 1800
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR}")
endif()
