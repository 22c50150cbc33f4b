# SPDX-License-Identifier: GPL-3.0-or-later
# libFuzzer on the DICOM scanner, the decoding child and the archive reader: TREPHINE_FUZZ_S seconds each, 6 if not set.
add_executable(fuzz_corpus fuzz/corpus.cpp)
target_link_libraries(fuzz_corpus PRIVATE trephine_phantom ZLIB::ZLIB)
add_test(NAME fuzz.build COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/fuzz/run.sh build ${PROJECT_BINARY_DIR}/fuzz)
set_tests_properties(fuzz.build PROPERTIES FIXTURES_SETUP fuzzers SKIP_RETURN_CODE 77 TIMEOUT 1800
  ENVIRONMENT "CORPUS=$<TARGET_FILE:fuzz_corpus>")
foreach(target scanner decoder archive)
  add_test(NAME fuzz.${target}
           COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/fuzz/run.sh ${target} ${PROJECT_BINARY_DIR}/fuzz)
  set_tests_properties(fuzz.${target} PROPERTIES FIXTURES_REQUIRED fuzzers SKIP_RETURN_CODE 77 TIMEOUT 4000)
endforeach()
