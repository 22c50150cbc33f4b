# SPDX-License-Identifier: GPL-3.0-or-later
# Pages in a real browser; Debian's chromium and chromium-driver are in packages-check.txt.
if(TARGET trephine)
add_executable(page_samples page_samples.cpp)
trephine_light(page_samples)
target_link_libraries(page_samples PRIVATE trephine_page trephine_cases)
target_include_directories(page_samples PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
function(browser_test name)
  add_test(NAME browser.${name} COMMAND python3 ${CMAKE_CURRENT_SOURCE_DIR}/browser/${ARGN})
  set_tests_properties(browser.${name} PROPERTIES TIMEOUT 1800 SKIP_RETURN_CODE 77 ENVIRONMENT
    "TREPHINE=$<TARGET_FILE:trephine>;PAGE_SAMPLES=$<TARGET_FILE:page_samples>;PYTHONDONTWRITEBYTECODE=1")
endfunction()
foreach(mode webgl2 processor no-3d)
  browser_test(page_${mode} page.py ${mode})
endforeach()
browser_test(tampered tampered.py)
browser_test(index index.py)
endif()
