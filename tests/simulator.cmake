# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine-sim)
add_executable(write_sample_case write_sample_case.cpp)
target_link_libraries(write_sample_case PRIVATE trephine_cases trephine_voxel)
# The simulator as its user meets it, and what other people's programs get: each script is a test.
set(scripts simulator case_schema)
if(NOT TREPHINE_SANITIZE AND NOT TREPHINE_HEADLESS)  # whose libraries and flags somebody else's program lacks
  list(APPEND scripts simulator_links case_consumer)
endif()
if(NOT TREPHINE_SANITIZE AND TREPHINE_HEADLESS)
  list(APPEND scripts simulator_headless)
endif()
foreach(script ${scripts})
  add_test(NAME program.${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
  set_tests_properties(program.${script} PROPERTIES TIMEOUT 1800 SKIP_RETURN_CODE 77
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=$<TARGET_FILE:write_sample_case>;BUILD=${PROJECT_BINARY_DIR}")
endforeach()
endif()
