# SPDX-License-Identifier: GPL-3.0-or-later
# The Python package, with the Python that it was built for.
if(TARGET trephine_python)
set(environment "PYTHONPATH=${CMAKE_BINARY_DIR}/python;PYTHONDONTWRITEBYTECODE=1;SOURCE=${PROJECT_SOURCE_DIR};TREPHINE=$<TARGET_FILE:trephine>;SIM=$<TARGET_FILE:trephine-sim>;WRITE_CASE=$<TARGET_FILE:write_sample_case>")
file(GLOB scripts CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/python/*_test.py)
foreach(script ${scripts})
  get_filename_component(name ${script} NAME_WE)
  string(REPLACE "_test" "" name ${name})
  add_test(NAME python.${name} COMMAND ${Python_EXECUTABLE} ${script})
  set_tests_properties(python.${name} PROPERTIES TIMEOUT 1800 ENVIRONMENT "${environment}")
endforeach()
endif()
