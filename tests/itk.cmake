# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine-itk AND TARGET trephine_phantom)
trephine_test(itk itk dicom phantom library)
add_dependencies(itk_test trephine-itk)
find_package(HDF5 REQUIRED COMPONENTS C)  # tests make files of it that a program of good will would not
target_link_libraries(itk_test PRIVATE hdf5::hdf5)
# No program but trephine-itk loads ITK, and none loads VTK, assimp or GDCM before it needs them.
if(NOT TREPHINE_SANITIZE)
  add_test(NAME program.libraries_apart COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/libraries_apart.sh)
  set_tests_properties(program.libraries_apart PROPERTIES
    ENVIRONMENT "BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
endif()
# A second scan as its user registers it, and cases of several. All work in one head.
set(head ${CMAKE_CURRENT_BINARY_DIR}/head_with_mr)
add_test(NAME program.head_with_mr COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/head_with_mr.sh ${head})
set_tests_properties(program.head_with_mr PROPERTIES FIXTURES_SETUP head_with_mr TIMEOUT 1800
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>")
foreach(which second_scan several_scans second_face Long_given_scans)
  string(REPLACE "Long_" "" script ${which})
  add_test(NAME program.${which} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
  set_tests_properties(program.${which} PROPERTIES FIXTURES_REQUIRED head_with_mr TIMEOUT 1800
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};HEAD=${head}")
endforeach()
add_test(NAME program.Long_two_kernels COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/two_kernels.sh)
set_tests_properties(program.Long_two_kernels PROPERTIES TIMEOUT 1800
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR}")
endif()
