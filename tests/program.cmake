# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine)
# The program as its user meets it. Each script is a test.
foreach(script bad_input correction dead_child export flags foreign_meshes left_out limits other_part outputs preview privacy readme refused same_bytes scan_names rerun)
  add_test(NAME program.${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
  set_tests_properties(program.${script} PROPERTIES TIMEOUT 1800
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};SIM=$<$<TARGET_EXISTS:trephine-sim>:$<TARGET_FILE:trephine-sim>>;FAULT=$<$<TARGET_EXISTS:library_fault>:$<TARGET_FILE:library_fault>>")
endforeach()
# What would take too long among the default tests: other scripts, and some of the same on the scan's own voxels.
foreach(script anatomies export findings outputs privacy readme remedies rerun same_bytes)
  add_test(NAME program.Long_${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
  set_tests_properties(program.Long_${script} PROPERTIES TIMEOUT 1800
    ENVIRONMENT "LONG=1;TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR}")
endforeach()
endif()
if(TARGET trephine AND TARGET trephine-sim)
  add_test(NAME program.escapes COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/escapes.sh)
  set_tests_properties(program.escapes PROPERTIES TIMEOUT 1800
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SIM=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
endif()
# How the programs are linked: what is built, and what is installed of it.
if(TARGET trephine AND TARGET trephine-sim AND TARGET trephine-itk)
  add_test(NAME program.hardened COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/hardened.sh)
  set_tests_properties(program.hardened PROPERTIES TIMEOUT 1800
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};BUILD=${PROJECT_BINARY_DIR};COMPILED_HARDENED=$<$<NOT:$<BOOL:${TREPHINE_SANITIZE}>>:1>;FORTIFIED=$<CONFIG:Release,RelWithDebInfo,MinSizeRel>")
endif()
if(TARGET trephine-tetra AND TARGET trephine-sim)
  foreach(which solids:0 Long_solids:1)
    string(REPLACE ":" ";" which ${which})
    list(GET which 0 name)
    list(GET which 1 long)
    add_test(NAME program.${name} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/solids.sh)
    set_tests_properties(program.${name} PROPERTIES TIMEOUT 1800 SKIP_RETURN_CODE 77
      ENVIRONMENT "LONG=${long};TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case")
  endforeach()
endif()
