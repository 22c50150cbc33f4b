# SPDX-License-Identifier: GPL-3.0-or-later
# How a module, a test and the sanitizers are declared.

set(TREPHINE_SANITIZE "" CACHE STRING "Sanitizers to build with, as -fsanitize= takes them")
if(TREPHINE_SANITIZE)
  add_compile_options(-fsanitize=${TREPHINE_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${TREPHINE_SANITIZE})
endif()

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # The sloppiness is what ccache asks for to cache files that use a precompiled header.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${CCACHE})
  add_compile_options(-fpch-preprocess)
endif()

# trephine_module(NAME [DEPENDS modules] [PUBLIC targets] [PRIVATE targets] [PCH headers])
# Every .cpp of the folder is compiled into the static library trephine_NAME. DEPENDS names modules above it in design.md;
# third-party libraries go to PRIVATE, so that their headers reach nobody else.
function(trephine_module name)
  cmake_parse_arguments(M "" "" "DEPENDS;PUBLIC;PRIVATE;PCH" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_library(trephine_${name} STATIC ${sources})
  target_include_directories(trephine_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/lib>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/trephine>)
  foreach(d ${M_DEPENDS})
    target_link_libraries(trephine_${name} PUBLIC trephine_${d})
  endforeach()
  target_link_libraries(trephine_${name} PUBLIC ${M_PUBLIC} PRIVATE ${M_PRIVATE})
  if(M_PCH)
    target_precompile_headers(trephine_${name} PRIVATE ${M_PCH})
  endif()
endfunction()

# trephine_registry(TARGET TYPE SUFFIX HEADER [FOLDER]): every NAME_SUFFIX.cpp of the folder defines `TYPE NAME_SUFFIX()`; this
# makes `const std::vector<TYPE>& SUFFIX_types()`, which HEADER declares, of all of them, by name. So adding one takes no list.
function(trephine_registry target type suffix header)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${ARGV4}/*_${suffix}.cpp)
  list(SORT sources)
  set(declarations "")
  set(calls "")
  foreach(source ${sources})
    get_filename_component(name ${source} NAME_WE)
    string(APPEND declarations "${type} ${name}();\n")
    string(APPEND calls "      ${name}(),\n")
  endforeach()
  set(file ${CMAKE_CURRENT_BINARY_DIR}/${suffix}_registry.cpp)
  file(CONFIGURE OUTPUT ${file} @ONLY CONTENT [[// Made by cmake/modules.cmake from the names of the sources.
#include "@header@"

namespace trephine {

@declarations@
const std::vector<@type@>& @suffix@_types() {
  static const std::vector<@type@> types = {
@calls@  };
  return types;
}

}  // namespace trephine
]])
  target_sources(${target} PRIVATE ${file})
endfunction()

# trephine_test(NAME modules...): tests/NAME_test.cpp (and tests/NAME_*_test.cpp) against the modules, run by CTest.
function(trephine_test name)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}_test.cpp
       ${CMAKE_CURRENT_SOURCE_DIR}/${name}_*_test.cpp)
  add_executable(${name}_test ${sources})
  target_link_libraries(${name}_test PRIVATE trephine_test_main)
  foreach(m ${ARGN})
    target_link_libraries(${name}_test PRIVATE trephine_${m})
  endforeach()
  gtest_discover_tests(${name}_test TEST_PREFIX ${name}. DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
                       PROPERTIES TIMEOUT 1200)
endfunction()
