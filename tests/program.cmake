# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine)
# The program as its user meets it. Each script is a test.
foreach(script anatomies bad_input correction dead_child export flags foreign_meshes left_out limits outputs preview privacy readme refused same_bytes scan_names rerun)
  add_test(NAME program.${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
  set_tests_properties(program.${script} PROPERTIES TIMEOUT 1800
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};FAULT=$<$<TARGET_EXISTS:library_fault>:$<TARGET_FILE:library_fault>>")
endforeach()
# What would take too long among the default tests: the same scripts on the scan's own voxels.
foreach(script export outputs privacy readme rerun same_bytes)
  add_test(NAME program.Long_${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
  set_tests_properties(program.Long_${script} PROPERTIES TIMEOUT 1800
    ENVIRONMENT "LONG=1;TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR}")
endforeach()
endif()
