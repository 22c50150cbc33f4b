// SPDX-License-Identifier: GPL-3.0-or-later
// write_sample_case FOLDER [full|drill|plate|play|head|head_drilled|spine|spine_without_ct|chest]: writes a small case
// of every part, one of full size, one with bone to drill, one with bone under scalp, or a head, spine or chest for
// lessons, for the tests of programs.
#include <iostream>

#include "case_samples.h"
#include "lessons_chest_phantom.h"
#include "lessons_phantom.h"
#include "lessons_spine.h"

int main(int argc, char** argv) {
  if (argc < 2) return 64;
  try {
    const std::string kind = argc > 2 ? argv[2] : "";
    if (kind == "head" || kind == "head_drilled") {
      ::lesson_cases::head_case(kind == "head" ? ::lesson_cases::Kind::whole : ::lesson_cases::Kind::drilled)
          .write(argv[1]);
      return 0;
    }
    if (kind == "chest") {
      lessons_chest::chest_case(false).write(argv[1]);
      return 0;
    }
    if (kind == "spine" || kind == "spine_without_ct") {
      case_samples::MemoryCase c = ::lesson_cases::spine_case();
      if (kind != "spine") {
        c.manifest.ct = {};
        c.manifest.files.pop_back();
        c.seal();
      }
      c.write(argv[1]);
      return 0;
    }
    (kind == "full"    ? case_samples::full_size_case()
     : kind == "drill" ? case_samples::drill_case()
     : kind == "plate" ? case_samples::plate_case()
     : kind == "play"  ? case_samples::play_case()
                       : case_samples::minimal_case())
        .write(argv[1]);
  } catch (const std::exception& e) {
    std::cerr << e.what() << "\n";
    return 70;
  }
}
