# SPDX-License-Identifier: GPL-3.0-or-later
# Script, style and templates of pages are plain files of web/ and become part of the program: a page needs no file beside it.
set(web ${PROJECT_SOURCE_DIR}/web)
set(WEB_CONTENT "")
# web_file(NAME sources...): the sources, one after the other, as the text NAME.
function(web_file name)
  set(text "")
  foreach(source ${ARGN})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${web}/${source})
    file(READ ${web}/${source} part)
    # Lines of comment and indentation are for who reads the sources; pages travel.
    string(REGEX REPLACE "(^|\n) *//[^\n]*" "\\1" part "${part}")
    string(REGEX REPLACE "\n[ \n]+" "\n" part "${part}")
    string(APPEND text "${part}")
  endforeach()
  string(FIND "${text}" ")web\"" clash)
  if(NOT clash EQUAL -1)
    message(FATAL_ERROR "web/${ARGN}: holds the end of a raw string")
  endif()
  # A compiler need not take a longer literal than 64 KiB; neighbours are joined.
  set(literals "")
  string(LENGTH "${text}" left)
  set(at 0)
  while(left GREATER 0)
    string(SUBSTRING "${text}" ${at} 16000 piece)
    string(APPEND literals "R\"web(${piece})web\"\n")
    math(EXPR at "${at} + 16000")
    math(EXPR left "${left} - 16000")
  endwhile()
  set(WEB_CONTENT "${WEB_CONTENT}const std::string_view ${name} = ${literals};\n" PARENT_SCOPE)
endfunction()
# write_web_files(HEADER NAMESPACE): web_files.cpp in the build's folder, with all texts so far.
function(write_web_files header namespace)
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/web_files.cpp @ONLY CONTENT [[// Made by cmake/web_files.cmake of web/.
#include "@header@"

namespace @namespace@ {
@WEB_CONTENT@
}  // namespace @namespace@
]])
endfunction()
