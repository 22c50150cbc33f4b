# SPDX-License-Identifier: GPL-3.0-or-later
# The generators of bench/attack: what they find is a fault. Each is run with a seed of its own.
if(TARGET trephine AND TARGET trephine-sim)
set(attack ${PROJECT_SOURCE_DIR}/bench/attack)
set(attack_programs --trephine $<TARGET_FILE:trephine> --sim $<TARGET_FILE:trephine-sim>)
add_test(NAME program.LongAttack_dicom COMMAND python3 ${attack}/dicom.py ${attack_programs} --seed 21 --count 600)
add_test(NAME program.LongAttack_attributes COMMAND python3 ${attack}/attributes.py ${attack_programs} --seed 21 --count 400)
add_test(NAME program.LongAttack_identity COMMAND python3 ${attack}/identity.py ${attack_programs} --seed 21 --count 200)
add_test(NAME program.LongAttack_cases
  COMMAND bash -c "work=$(mktemp -d) && trap 'rm -rf \"$work\"' EXIT && \"$0\" \"$work/sample\" && python3 \"$@\" --case \"$work/sample\""
    $<TARGET_FILE:write_sample_case> ${attack}/cases.py ${attack_programs} --seed 21 --count 600)
add_test(NAME program.LongAttack_cases_with_ct
  COMMAND bash -c "work=$(mktemp -d) && trap 'rm -rf \"$work\"' EXIT && \"$0\" \"$work/spine\" spine && python3 \"$@\" --case \"$work/spine\""
    $<TARGET_FILE:write_sample_case> ${attack}/cases.py ${attack_programs} --seed 22 --count 200)
add_test(NAME program.LongAttack_volumes COMMAND python3 ${attack}/volumes.py ${attack_programs} --seed 21 --count 400)
add_test(NAME program.LongAttack_cache COMMAND python3 ${attack}/cache.py ${attack_programs} --seed 21 --count 20
  --config ${PROJECT_SOURCE_DIR}/configs/sample.yaml)
add_test(NAME program.LongAttack_landmarks COMMAND python3 ${attack}/landmarks.py ${attack_programs} --seed 21 --count 200)
# Those who stand beside the program: other users of the machine, pages, libraries, keys, and recipes of two scans.
add_test(NAME program.LongAttack_beside COMMAND python3 ${attack}/beside.py ${attack_programs} --seed 21 --count 300)
add_test(NAME program.LongAttack_signatures COMMAND python3 ${attack}/signatures.py ${attack_programs} --seed 21 --count 60)
add_test(NAME program.LongAttack_stranger COMMAND python3 ${attack}/stranger.py ${attack_programs} --seed 21 --count 2000 --pages 4)
add_test(NAME program.LongAttack_server COMMAND python3 ${attack}/server.py ${attack_programs} --seed 21 --count 200)
add_test(NAME program.LongAttack_links COMMAND python3 ${attack}/links.py ${attack_programs} --seed 21 --count 40)
add_test(NAME program.LongAttack_faces
  COMMAND python3 ${attack}/faces.py ${attack_programs} --timeout-s 600 --seed 21 --count 8 --head ${CMAKE_CURRENT_BINARY_DIR}/head_with_mr)
set_tests_properties(program.LongAttack_faces PROPERTIES FIXTURES_REQUIRED head_with_mr)
set(beside_attacks program.LongAttack_beside program.LongAttack_signatures program.LongAttack_stranger program.LongAttack_server
  program.LongAttack_links program.LongAttack_faces)
set_tests_properties(program.LongAttack_stranger PROPERTIES SKIP_RETURN_CODE 77)
set_tests_properties(${beside_attacks} program.LongAttack_dicom program.LongAttack_attributes program.LongAttack_identity program.LongAttack_cases program.LongAttack_cases_with_ct
  program.LongAttack_volumes program.LongAttack_cache program.LongAttack_landmarks
  PROPERTIES TIMEOUT 7200 ENVIRONMENT "PYTHONDONTWRITEBYTECODE=1")
endif()
