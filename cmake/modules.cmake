# SPDX-License-Identifier: GPL-3.0-or-later
# How a module, a test and the sanitizers are declared.

set(TREPHINE_SANITIZE "" CACHE STRING "Sanitizers to build with, as -fsanitize= takes them")
if(TREPHINE_SANITIZE)
  add_compile_options(-fsanitize=${TREPHINE_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${TREPHINE_SANITIZE})
else()
  # What a fault in a parser or a library meets: a canary before each return address, checked calls of libc where the size of
  # the target is known (which needs optimisation, and is the sanitizers' own affair), and jumps to the beginnings of functions
  # alone where the processor and the kernel see to it. program.hardened reads it.
  add_compile_options(-fstack-protector-strong)
  set(optimised $<CONFIG:Release,RelWithDebInfo,MinSizeRel>)
  add_compile_options($<${optimised}:-U_FORTIFY_SOURCE> $<${optimised}:-D_FORTIFY_SOURCE=2>)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|i[3-6]86)$")
    add_compile_options(-fcf-protection)
  endif()
endif()

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # The sloppiness is what ccache asks for to cache files that use a precompiled header.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${CCACHE})
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endif()

option(TREPHINE_UNITY "Compile several files of a room at once, which halves the time of a whole build" ON)

# The headers of the standard library that most files include, read once for all targets of the same options and not once a
# file. Only with TREPHINE_UNITY: other builds, and clang-tidy's, see whether a file includes what it uses.
# trephine_headers(NAME [options...]): declares such a set, trephine_use_headers(TARGET NAME) uses it.
function(trephine_headers name)
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp CONTENT "")
  add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  target_compile_options(${name} PRIVATE ${ARGN})
  target_precompile_headers(${name} PRIVATE <algorithm> <array> <atomic> <cmath> <cstdint> <cstdio> <cstring> <filesystem>
    <functional> <limits> <map> <memory> <mutex> <optional> <set> <string> <string_view> <thread> <utility> <variant> <vector>)
endfunction()
function(trephine_use_headers target name)
  if(TARGET ${name})
    set_target_properties(${target} PROPERTIES PRECOMPILE_HEADERS_REUSE_FROM ${name})
    add_dependencies(${target} ${name})
  endif()
endfunction()

include(${CMAKE_CURRENT_LIST_DIR}/unity.cmake)
function(trephine_unity target)
  if(NOT TREPHINE_UNITY)
    return()
  endif()
  trephine_unity_groups(${target} "" ${ARGN})
  trephine_use_headers(${target} trephine_headers)
endfunction()

# Compiled with -O1, in two thirds of the time: code that reads, arranges and prints, and spends its time in what it calls.
set(TREPHINE_LIGHT $<$<CONFIG:Release>:-O1>)
function(trephine_light target)
  target_compile_options(${target} PRIVATE ${TREPHINE_LIGHT})
  trephine_use_headers(${target} trephine_headers_light)
endfunction()
if(TREPHINE_UNITY AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  trephine_headers(trephine_headers)
  trephine_headers(trephine_headers_light ${TREPHINE_LIGHT})
endif()

# trephine_module(NAME [LIGHT] [DEPENDS modules] [PUBLIC targets] [PRIVATE targets])
# Every .cpp of the folder is compiled into the static library trephine_NAME. DEPENDS names modules above it in
# docs/developers/architecture.md; third-party libraries go to PRIVATE, so that their headers reach nobody else.
function(trephine_module name)
  cmake_parse_arguments(M "LIGHT" "" "DEPENDS;PUBLIC;PRIVATE" ${ARGN})
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
  trephine_unity(trephine_${name} ${sources})
  if(M_LIGHT)
    trephine_light(trephine_${name})
  endif()
endfunction()

# trephine_library_on_demand(NAME ROOM FOLDER sources...): the sources of the room's folder, and what they use of other rooms, in a
# library of our own that programs of the room load when they first need it (own_library of base/shared_library.h).
function(trephine_library_on_demand name room folder)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
  list(TRANSFORM ARGN PREPEND ${PROJECT_SOURCE_DIR}/lib/)
  add_library(${name} MODULE ${sources} ${ARGN})
  set_target_properties(${name} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/trephine
                        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/lib)
  target_link_options(${name} PRIVATE LINKER:-z,defs)
  target_compile_options(${name} PRIVATE ${TREPHINE_LIGHT})
  add_dependencies(trephine_${room} ${name})
  install(TARGETS ${name} LIBRARY DESTINATION lib/trephine COMPONENT programs)
endfunction()

# trephine_registry(TARGET TYPE SUFFIX HEADER [FOLDER]): every NAME_SUFFIX.cpp of the folder (of each, where FOLDER ends in /*)
# defines `TYPE NAME_SUFFIX()`; this makes `const std::vector<TYPE>& SUFFIX_types()`, which HEADER declares, of all of them, by
# name. So adding one takes no list.
function(trephine_registry target type suffix header)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${ARGV4}/*_${suffix}.cpp)
  list(SORT sources)
  get_filename_component(room ${header} DIRECTORY)  # its namespace
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

namespace trephine::@room@ {

@declarations@
const std::vector<@type@>& @suffix@_types() {
  static const std::vector<@type@> types = {
@calls@  };
  return types;
}

}  // namespace trephine::@room@
]])
  target_sources(${target} PRIVATE ${file})
endfunction()

# trephine_test(NAME modules...): tests/NAME_test.cpp (and tests/NAME_*_test.cpp) against the modules, run by CTest. NAME is that of the
# room that they test, or is listed here as one of several rooms.
set(TREPHINE_TESTS_OF_ROOMS cut_surface oracle)
function(trephine_test name)
  if(NOT name IN_LIST TREPHINE_TESTS_OF_ROOMS AND NOT IS_DIRECTORY ${PROJECT_SOURCE_DIR}/lib/${name}
     AND NOT IS_DIRECTORY ${PROJECT_SOURCE_DIR}/simulator/${name})
    message(FATAL_ERROR "trephine_test(${name}): no room of that name is in lib or simulator. Name the test after its room, or add it to "
                        "TREPHINE_TESTS_OF_ROOMS (CONTRIBUTING.md, \"Add a test\").")
  endif()
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}_test.cpp
       ${CMAKE_CURRENT_SOURCE_DIR}/${name}_*_test.cpp)
  set_property(GLOBAL APPEND PROPERTY TREPHINE_TEST_SOURCES ${sources})
  add_executable(${name}_test ${sources})
  trephine_unity(${name}_test ${sources})
  trephine_light(${name}_test)
  trephine_use_headers(${name}_test trephine_headers_test)
  target_link_libraries(${name}_test PRIVATE trephine_test_main)
  foreach(m ${ARGN})
    target_link_libraries(${name}_test PRIVATE trephine_${m})
  endforeach()
  # Tests that share a phantom which takes longer to make than they do are one test of CTest: TREPHINE_TEST_AT_ONCE.
  set(discovered)
  if(${name} IN_LIST TREPHINE_TEST_AT_ONCE)
    add_test(NAME ${name}.all COMMAND ${name}_test --gtest_filter=-*Long*)
    set_tests_properties(${name}.all PROPERTIES TIMEOUT 1800)
    set(discovered TEST_FILTER *Long*)
  endif()
  gtest_discover_tests(${name}_test TEST_PREFIX ${name}. DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 1800 ${discovered}
                       PROPERTIES TIMEOUT 1800)
endfunction()

# trephine_no_test_is_lost(): fails for a tests/*_test.cpp that no test program compiles, which would never run.
function(trephine_no_test_is_lost)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*_test.cpp)
  get_property(compiled GLOBAL PROPERTY TREPHINE_TEST_SOURCES)
  list(REMOVE_ITEM sources ${compiled})
  foreach(source ${sources})
    get_filename_component(file ${source} NAME)
    string(REGEX REPLACE "_.*" "" name ${file})
    message(FATAL_ERROR "tests/${file} belongs to no test program. Write tests/${name}.cmake with trephine_test(${name} ROOMS), "
                        "or begin the file's name with that of a program that there is (CONTRIBUTING.md, \"Add a test\").")
  endforeach()
endfunction()
