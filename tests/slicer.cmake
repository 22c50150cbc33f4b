# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(slicer slicer)
if(TARGET trephine AND TARGET write_sample_case)
  foreach(script slicer_scene slicer_modules)
    add_test(NAME program.${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
    set_tests_properties(program.${script} PROPERTIES TIMEOUT 1800 SKIP_RETURN_CODE 77
      ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=$<TARGET_FILE:write_sample_case>;MODULES=${slicer_modules}")
  endforeach()
endif()
