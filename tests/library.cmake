# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine AND TARGET trephine_library)
trephine_test(library library)
# Makes the n-th call of a system call or malloc fail in whatever program it is loaded into.
add_library(library_fault MODULE ${CMAKE_CURRENT_SOURCE_DIR}/library_fault.c)
target_link_libraries(library_fault PRIVATE ${CMAKE_DL_LIBS})
foreach(script library library_canaries library_slurm library_faults case_faults library_kills library_long_faults library_long_kills library_long_sample library_long_slurm library_long_thousand)
  string(REPLACE "library_long_" "LongLibrary_" name ${script})
  add_test(NAME program.${name} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
  set_tests_properties(program.${name} PROPERTIES TIMEOUT 7200
    ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};FAULT=$<TARGET_FILE:library_fault>")
endforeach()
add_test(NAME program.LongLibrary_first_publication COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/first_publication.sh)
set_tests_properties(program.LongLibrary_first_publication PROPERTIES TIMEOUT 7200
  ENVIRONMENT "LONG=1;TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR};FAULT=$<TARGET_FILE:library_fault>")
endif()
