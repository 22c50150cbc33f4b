# SPDX-License-Identifier: GPL-3.0-or-later
# The rules of the house, by script.
set(house ${CMAKE_CURRENT_SOURCE_DIR}/house)
add_test(NAME house.include_directions COMMAND bash ${house}/include_directions.sh ${PROJECT_SOURCE_DIR})
add_test(NAME house.include_directions_selftest
         COMMAND bash ${house}/include_directions_selftest.sh ${house}/include_directions.sh)
add_test(NAME house.one_definition COMMAND bash ${house}/one_definition.sh ${PROJECT_SOURCE_DIR} ${CMAKE_CXX_COMPILER})
add_test(NAME house.one_definition_selftest
         COMMAND bash ${house}/one_definition_selftest.sh ${house}/one_definition.sh ${CMAKE_CXX_COMPILER})
add_test(NAME house.sizes COMMAND bash ${house}/sizes.sh ${PROJECT_SOURCE_DIR})
add_test(NAME house.sizes_selftest COMMAND bash ${house}/sizes_selftest.sh ${house}/sizes.sh)
add_test(NAME house.sizes_table
         COMMAND python3 ${PROJECT_SOURCE_DIR}/bench/sizes.py ${PROJECT_SOURCE_DIR} --check ${PROJECT_SOURCE_DIR}/docs/architecture.md)
add_test(NAME house.anatomies COMMAND bash ${house}/anatomies.sh ${PROJECT_SOURCE_DIR})
add_test(NAME house.anatomies_selftest COMMAND bash ${house}/anatomies_selftest.sh ${house}/anatomies.sh)
add_test(NAME house.tools COMMAND bash ${house}/tools.sh ${PROJECT_SOURCE_DIR})
add_test(NAME house.tools_selftest COMMAND bash ${house}/tools_selftest.sh ${house}/tools.sh)
add_test(NAME house.spdx COMMAND bash ${house}/spdx.sh ${PROJECT_SOURCE_DIR})
add_test(NAME house.format COMMAND bash ${house}/format.sh ${PROJECT_SOURCE_DIR})
set_tests_properties(house.format PROPERTIES SKIP_RETURN_CODE 77)
add_test(NAME house.refusals COMMAND python3 ${house}/refusals.py ${PROJECT_SOURCE_DIR})
add_test(NAME house.bibliography COMMAND python3 ${house}/bibliography.py ${PROJECT_SOURCE_DIR})
add_test(NAME house.contributing
         COMMAND bash ${house}/contributing.sh ${PROJECT_SOURCE_DIR} ${CMAKE_CXX_COMPILER})
add_test(NAME house.sinks COMMAND python3 ${house}/sinks.py ${PROJECT_SOURCE_DIR})
add_test(NAME house.sinks_selftest COMMAND python3 ${house}/sinks.py ${PROJECT_SOURCE_DIR} --selftest)
add_test(NAME house.links COMMAND python3 ${house}/links.py ${PROJECT_SOURCE_DIR})
add_test(NAME house.site COMMAND bash ${PROJECT_SOURCE_DIR}/docs/build_site.sh ${CMAKE_CURRENT_BINARY_DIR}/site)
set_tests_properties(house.site PROPERTIES SKIP_RETURN_CODE 77)
add_test(NAME house.site_told COMMAND bash ${house}/site_told.sh ${PROJECT_SOURCE_DIR})
if(TARGET trephine)
  add_test(NAME house.reference COMMAND bash ${house}/reference.sh $<TARGET_FILE:trephine> ${PROJECT_SOURCE_DIR})
endif()
if(TARGET trephine-sim)
  add_test(NAME house.reference_sim
           COMMAND bash ${house}/reference.sh $<TARGET_FILE:trephine-sim> ${PROJECT_SOURCE_DIR} docs/reference-sim)
endif()
add_test(NAME house.schemas COMMAND /usr/bin/python3 ${house}/schemas.py ${PROJECT_SOURCE_DIR})
set_tests_properties(house.schemas PROPERTIES SKIP_RETURN_CODE 77)
