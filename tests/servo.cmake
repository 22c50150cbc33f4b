# SPDX-License-Identifier: GPL-3.0-or-later
if(TARGET trephine-sim)
add_library(adaptor_stub MODULE adaptor_stub.c)
set_target_properties(adaptor_stub PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
target_include_directories(adaptor_stub PRIVATE ${PROJECT_SOURCE_DIR}/simulator)
add_library(gamepad_stub MODULE gamepad_stub.c)
target_link_libraries(gamepad_stub PRIVATE ${CMAKE_DL_LIBS})
add_library(asound_stub MODULE asound_stub.c)
add_library(spnav_stub MODULE spnav_stub.c)  # found by its name, as the one of a system would be
set_target_properties(gamepad_stub PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
set_target_properties(asound_stub PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
set_target_properties(spnav_stub PROPERTIES OUTPUT_NAME spnav SUFFIX ".so.0"
  LIBRARY_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/stubs)
# Vendors' libraries as their references describe them, written by somebody who had not read the adaptors.
foreach(vendor dhd hd)
  add_library(${vendor}_fake MODULE fakes/${vendor}_fake.c)
  set_target_properties(${vendor}_fake PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/stubs)
  target_link_libraries(${vendor}_fake PRIVATE Threads::Threads m)
endforeach()
foreach(script calibrate servo servo_adaptor servo_drill servo_haply servo_pushed servo_sound servo_udp servo_vendors touched)
add_test(NAME program.${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
set_tests_properties(program.${script} PROPERTIES TIMEOUT 1800
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR};WRITE_CASE=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/write_sample_case;STUB=$<TARGET_FILE:adaptor_stub>;PAD_STUB=$<TARGET_FILE:gamepad_stub>;SPNAV_STUB=$<TARGET_FILE:spnav_stub>;ASOUND_STUB=$<TARGET_FILE:asound_stub>;DHD_ADAPTOR=$<TARGET_FILE:force_dimension>;HD_ADAPTOR=$<TARGET_FILE:open_haptics>;HAPLY_ADAPTOR=$<TARGET_FILE:haply>;DHD_FAKE=$<TARGET_FILE:dhd_fake>;HD_FAKE=$<TARGET_FILE:hd_fake>")
endforeach()
get_test_property(program.servo_vendors ENVIRONMENT environment)
foreach(script servo_haply servo_vendors)
  add_test(NAME program.Long_${script} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/${script}.sh)
  set_tests_properties(program.Long_${script} PROPERTIES TIMEOUT 1800 ENVIRONMENT "LONG=1;${environment}")
endforeach()
add_test(NAME program.flags_sim COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/program/flags.sh)
set_tests_properties(program.flags_sim PROPERTIES TIMEOUT 1800
  ENVIRONMENT "TREPHINE=$<TARGET_FILE:trephine-sim>;SOURCE=${PROJECT_SOURCE_DIR}")
endif()
