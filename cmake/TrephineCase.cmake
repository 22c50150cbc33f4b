# SPDX-License-Identifier: GPL-3.0-or-later
# The CMake package TrephineCase: what reads a case, for other people's simulators (docs/reference/case-package.md). Static
# libraries and their headers; component `development`.
include(CMakePackageConfigHelpers)
set(case_modules base json grid surface voxel contact cases)
# What other programs may include; each of these compiles alone (tests/program/case_consumer.sh).
set(base_headers error exit_code parallel parameter params progress report result vec3 warning)
set(json_headers declared_json json_bounds)
set(grid_headers grid gzip_limit nrrd)
set(surface_headers bvh distance_function inside mesh_array point_to_mesh point_triangle trimesh)
set(voxel_headers cut decode haptic_file haptic_volume mismatch transfer voxelize)
set(contact_headers contact contact_c)
set(cases_headers case case_finding case_values glb load_case material)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/TrephineCase)

foreach(module ${case_modules})
  if(NOT TARGET trephine_${module})
    return()
  endif()
endforeach()
if(TARGET trephine_headers)
  trephine_headers(trephine_headers_pic -fno-semantic-interposition)
  set_target_properties(trephine_headers_pic PROPERTIES POSITION_INDEPENDENT_CODE ON)
endif()
foreach(module ${case_modules})
  # A plug-in of a game engine is a shared library: what it links must be position independent.
  set_target_properties(trephine_${module} PROPERTIES EXPORT_NAME ${module} POSITION_INDEPENDENT_CODE ON)
  target_compile_options(trephine_${module} PRIVATE -fno-semantic-interposition)
  trephine_use_headers(trephine_${module} trephine_headers_pic)
  target_compile_features(trephine_${module} INTERFACE cxx_std_17)
  list(TRANSFORM ${module}_headers PREPEND ${PROJECT_SOURCE_DIR}/lib/${module}/ OUTPUT_VARIABLE headers)
  list(TRANSFORM headers APPEND .h)
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/trephine/${module} COMPONENT development)
  install(TARGETS trephine_${module} EXPORT TrephineCaseTargets
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
endforeach()
install(EXPORT TrephineCaseTargets NAMESPACE TrephineCase:: DESTINATION ${package_dir} COMPONENT development)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/TrephineCaseConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/TrephineCaseConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/TrephineCaseConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/TrephineCaseConfig.cmake ${PROJECT_BINARY_DIR}/TrephineCaseConfigVersion.cmake
        DESTINATION ${package_dir} COMPONENT development)
