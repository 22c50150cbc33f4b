# SPDX-License-Identifier: GPL-3.0-or-later
trephine_test(pacs pacs segmentation phantom)
if(TARGET trephine)
  foreach(long 0 1)
    if(long)
      set(name program.LongDicom_objects)
    else()
      set(name program.dicom_objects)
    endif()
    add_test(NAME ${name} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/dicom_objects.sh)
    set_tests_properties(${name} PROPERTIES TIMEOUT 1800 SKIP_RETURN_CODE 77
      ENVIRONMENT "LONG=${long};TREPHINE=$<TARGET_FILE:trephine>;SOURCE=${PROJECT_SOURCE_DIR}")
  endforeach()
endif()
