# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine-tetra)
trephine_test(tetra tetra meshio)
target_sources(tetra_test PRIVATE ${PROJECT_SOURCE_DIR}/lib/tetra/program/filled.cpp)
add_dependencies(tetra_test trephine-tetra)
find_package(VTK REQUIRED COMPONENTS CommonCore CommonDataModel IOXML)
target_link_libraries(tetra_test PRIVATE VTK::CommonCore VTK::CommonDataModel VTK::IOXML)
endif()
