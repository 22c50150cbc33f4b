# SPDX-License-Identifier: GPL-3.0-or-later
# Every stage at the ends of its parameters and of its input; `extremes_test --write docs/extremes.md` writes the table.
if(TARGET trephine_stages)
file(GLOB extremes CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/extremes/*.cpp)
add_executable(extremes_test ${extremes})
trephine_unity(extremes_test ${extremes})
target_link_libraries(extremes_test PRIVATE trephine_stages trephine_meshio GTest::gtest)
add_dependencies(extremes_test trephine-itk)
target_include_directories(extremes_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(extremes_test PRIVATE TREPHINE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
# One process for many sections: they share their scenes.
foreach(part convergence export parameters inputs)
  add_test(NAME extremes.${part} COMMAND extremes_test --gtest_filter=Extremes.*/${part}*)
endforeach()
add_test(NAME extremes.stages COMMAND extremes_test --gtest_filter=ExtremesOf.*)
add_test(NAME extremes.LongExtremes COMMAND extremes_test --gtest_filter=LongExtremes.*)
set_tests_properties(extremes.convergence extremes.export extremes.parameters extremes.inputs extremes.stages
                     extremes.LongExtremes PROPERTIES TIMEOUT 1200)
endif()
