# SPDX-License-Identifier: GPL-3.0-or-later
# trephine_unity_groups(TARGET PREFIX sources...): these sources are compiled in groups of a few, as unity_groups.awk forms them: never
# two whose names meet, nor more than TREPHINE_UNITY_LINES lines, for one edit compiles a whole group. PREFIX keeps the groups of
# several rooms in one target apart.
set(TREPHINE_UNITY_LINES 1600)
set(TREPHINE_UNITY_GROUPS ${CMAKE_CURRENT_LIST_DIR}/unity_groups.awk)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${TREPHINE_UNITY_GROUPS})
function(trephine_unity_groups target prefix)
  execute_process(COMMAND awk -v most_lines=${TREPHINE_UNITY_LINES} -f ${TREPHINE_UNITY_GROUPS} ${ARGN}
                  OUTPUT_VARIABLE groups OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  string(REPLACE "\n" ";" groups "${groups}")
  foreach(line ${groups})
    string(REGEX MATCH "^([0-9]+) (.*)$" _ "${line}")
    set_source_files_properties(${CMAKE_MATCH_2} PROPERTIES UNITY_GROUP ${prefix}${CMAKE_MATCH_1})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)  # as in one file alone
endfunction()
