# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine-itk AND TARGET trephine_phantom)
trephine_test(itk itk dicom phantom)
add_dependencies(itk_test trephine-itk)
# No program but trephine-itk loads ITK.
if(NOT TREPHINE_SANITIZE)
  add_test(NAME program.itk_apart COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/itk_apart.sh)
  set_tests_properties(program.itk_apart PROPERTIES
    ENVIRONMENT "BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
endif()
# A second scan as its user registers it, and a case of several.
foreach(script second_scan several_scans)
  add_test(NAME program.${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
  set_tests_properties(program.${script} PROPERTIES TIMEOUT 600
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR}")
endforeach()
endif()
