# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine-tetra)
trephine_test(tetra tetra meshio)
target_sources(tetra_test PRIVATE ${PROJECT_SOURCE_DIR}/lib/tetra/program/filled.cpp)
target_include_directories(tetra_test PRIVATE ${PROJECT_SOURCE_DIR}/lib/tetra)
add_dependencies(tetra_test trephine-tetra)
endif()
