# SPDX-License-Identifier: GPL-3.0-or-later
# The pages of the reference come from the commands' declarations, when a program is linked: build/release/docs/reference/PROGRAM. They
# are installed beside the pages of docs/reference.
set(references "")
foreach(program trephine trephine-sim)
  if(TARGET ${program})
    set(reference ${PROJECT_BINARY_DIR}/docs/reference/${program})
    add_custom_command(OUTPUT ${reference}.stamp
      COMMAND ${CMAKE_COMMAND} -E rm -rf ${reference}
      COMMAND ${program} reference --out ${reference}
      COMMAND ${CMAKE_COMMAND} -E touch ${reference}.stamp
      DEPENDS ${program} VERBATIM)
    list(APPEND references ${reference}.stamp)
    install(DIRECTORY ${reference}/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs/reference/${program} COMPONENT programs)
  endif()
endforeach()
add_custom_target(reference ALL DEPENDS ${references})
