# SPDX-License-Identifier: GPL-3.0-or-later
# Commands as modules of 3D Slicer: a launcher each, in a folder that its module path can name.
set(slicer_modules ${CMAKE_BINARY_DIR}/lib/trephine/slicer-modules)
foreach(module TrephineRun=run TrephineExport=export TrephineMeasure=measure)
  string(REPLACE "=" ";" pair ${module})
  list(GET pair 0 name)
  list(GET pair 1 command)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/slicer_module.sh.in ${slicer_modules}/${name} @ONLY
    FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
endforeach()
install(DIRECTORY ${slicer_modules}/ DESTINATION lib/trephine/slicer-modules COMPONENT programs USE_SOURCE_PERMISSIONS)
