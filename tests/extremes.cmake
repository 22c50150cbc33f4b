# SPDX-License-Identifier: GPL-3.0-or-later
# Every stage at the ends of its parameters and of its input; `extremes_test --write docs/extremes.md` writes the table.
if(TARGET trephine_stages)
file(GLOB extremes CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/extremes/*.cpp)
add_executable(extremes_test ${extremes})
target_link_libraries(extremes_test PRIVATE trephine_stages trephine_meshio GTest::gtest)
target_include_directories(extremes_test PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(extremes_test PRIVATE TREPHINE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
gtest_discover_tests(extremes_test TEST_PREFIX extremes. DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
                     PROPERTIES TIMEOUT 600)
endif()
