# SPDX-License-Identifier: GPL-3.0-or-later
# What is installed beside the programs, and the Debian packages: `cpack -G DEB --config build/release/CPackConfig.cmake`
# makes trephine (component `programs`), trephine-dev (component `development`) and, with TREPHINE_PYTHON, python3-trephine (`python`).

# The configurations find each other, and the sample, below the installed trephine.root as they do below the source's.
install(DIRECTORY pipelines configs sample_dicom DESTINATION ${CMAKE_INSTALL_DATADIR}/trephine COMPONENT programs)
install(DIRECTORY examples/lessons DESTINATION ${CMAKE_INSTALL_DATADIR}/trephine/examples COMPONENT programs)
install(FILES trephine.root DESTINATION ${CMAKE_INSTALL_DATADIR}/trephine COMPONENT programs)
install(FILES README.md LICENSE CONTRIBUTING.md CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT programs)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT programs PATTERN "*.sh" EXCLUDE PATTERN "*.js" EXCLUDE)
install(DIRECTORY examples/case_reader examples/contact examples/udp_client examples/python_reader examples/dicom_overlay
                  examples/slicer_scene examples/ambf_stack examples/recording_data examples/pressed_brain
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/trephine-dev/examples
        COMPONENT development)

# Manual pages and bash's completion come from the commands' declarations, when a program is linked.
set(generated ${PROJECT_BINARY_DIR}/package)
foreach(program trephine trephine-sim)
  if(NOT TARGET ${program} OR TREPHINE_SANITIZE)
    return()
  endif()
  set(man ${generated}/${program}/man1)
  set(completion ${generated}/${program}/completions)
  add_custom_command(OUTPUT ${generated}/${program}.stamp
    COMMAND ${CMAKE_COMMAND} -E rm -rf ${man} ${completion}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${man} ${completion}
    COMMAND ${program} man --out ${man}
    COMMAND sh -c "gzip -9n \"$0\"/*.1" ${man}
    COMMAND sh -c "\"$0\" completion bash >\"$1\"" $<TARGET_FILE:${program}> ${completion}/${program}
    COMMAND ${CMAKE_COMMAND} -E touch ${generated}/${program}.stamp
    DEPENDS ${program} VERBATIM)
  list(APPEND stamps ${generated}/${program}.stamp)
  install(DIRECTORY ${man}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
  install(DIRECTORY ${completion}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT programs)
endforeach()
add_custom_target(manual ALL DEPENDS ${stamps})

file(MAKE_DIRECTORY ${generated})
execute_process(COMMAND gzip -9nc ${PROJECT_SOURCE_DIR}/cmake/debian/changelog OUTPUT_FILE ${generated}/changelog.gz)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS cmake/debian/changelog)
set(packages programs:trephine development:trephine-dev)
if(TREPHINE_PYTHON)
  list(APPEND packages python:python3-trephine)
  install(DIRECTORY examples/python DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-trephine/examples COMPONENT python)
endif()
foreach(component_folder ${packages})
  string(REGEX MATCH "(.*):(.*)" _ ${component_folder})
  install(FILES cmake/debian/copyright ${generated}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CMAKE_MATCH_2}
          COMPONENT ${CMAKE_MATCH_1})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PACKAGE_CONTACT "Trephine maintainers <maintainers@trephine.example>" CACHE STRING "Maintainer of the packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
# The same build gives the same bytes: entries are dated by the last commit, and have their modes whatever the umask
# (the mode that the archive gives control.tar and data.tar follows it; nobody reads that).
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian/modes.cmake)
set(TREPHINE_SOURCE_DIR ${PROJECT_SOURCE_DIR})
configure_file(cmake/debian/date.cmake.in ${generated}/date.cmake @ONLY)
set(CPACK_PROJECT_CONFIG_FILE ${generated}/date.cmake)

string(REGEX REPLACE ":[^;]*" "" CPACK_COMPONENTS_ALL "${packages}")
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME trephine)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_DEPENDS "ninja-build, gnuplot-nox | gnuplot, fonts-dejavu-core")
# Ninja is for `library build`, gnuplot for `trade`, the typeface for the window.
set(CPACK_DEBIAN_PROGRAMS_DESCRIPTION "patient models for surgical simulation from CT series
Trephine turns a CT series into what a surgical simulator needs of one patient:
closed, decimated surfaces of the anatomies that a scene asks for, a haptic
volume, and burr holes in both, in one declared frame, with a measured error.
.
This package holds trephine, which makes cases, trephine-sim, which reads them,
configurations and pipelines, and a synthetic sample. It is a research tool and
not a medical device.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME trephine-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libfmt-dev, libssl-dev, libtbb-dev, zlib1g-dev")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "reading Trephine's cases in other simulators
Static libraries and headers that load and verify a case of trephine, and
decode and cut its haptic volume: find_package(TrephineCase) in CMake.")

if(TREPHINE_PYTHON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-trephine)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  math(EXPR next_python "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${next_python}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "Trephine's cases, stages and haptic sessions in Python
The package trephine reads a case as numpy arrays, runs the stages of the
toolchain on arrays, and moves a tool in a case: contact, force and drilling,
also as an environment with the interface of Gymnasium.")
endif()
include(CPack)
