# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine-tetra)
trephine_test(tetra tetra meshio)
target_sources(tetra_test PRIVATE ${PROJECT_SOURCE_DIR}/lib/tetra/program/filled.cpp)
add_dependencies(tetra_test trephine-tetra)
find_package(VTK REQUIRED COMPONENTS CommonCore CommonDataModel IOXML)
target_link_libraries(tetra_test PRIVATE VTK::CommonCore VTK::CommonDataModel VTK::IOXML)
else()  # a build without TREPHINE_TETRA leaves them out on purpose
file(GLOB left_out CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/tetra_*test.cpp)
set_property(GLOBAL APPEND PROPERTY TREPHINE_TEST_SOURCES ${left_out})
endif()
